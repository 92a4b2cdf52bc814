// Textures: import, mip levels, lookups on the host.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/image/image.h"
#include "engine/scene/gltf.h"
#include "engine/scene/texture.h"
#include "tests/gpu/expect_error.h"
#include "tests/scene/tiny_gltf.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace radivox::tests {
namespace {

using nlohmann::json;
using scene::Scene;
using scene::TextureImage;

TextureImage makeImage(uint32_t width, uint32_t height, const std::vector<uint8_t>& rgba, bool srgb = true) {
  TextureImage image;
  image.width = width;
  image.height = height;
  image.rgba = rgba;
  image.srgb = srgb;
  return image;
}

TextureImage makeNoise(uint32_t width, uint32_t height, bool srgb) {
  std::vector<uint8_t> rgba;
  uint32_t random = width * 7919 + height;
  for (uint32_t i = 0; i < width * height * 4; ++i) {
    random = random * 1664525u + 1013904223u;
    rgba.push_back(static_cast<uint8_t>(random >> 24));
  }
  return makeImage(width, height, rgba, srgb);
}

glm::dvec4 decodeTexel(uint32_t texel, bool srgb) {
  glm::dvec4 out;
  for (glm::length_t c = 0; c < 4; ++c) {
    const double v = (texel >> (8 * c) & 255u) / 255.0;
    out[c] = !srgb || c == 3 ? v : v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  return out;
}

TEST(MipTest, SizesAndLevelZero) {
  const TextureImage image = makeNoise(13, 6, true);
  const scene::MipChain chain = scene::buildMipChain(image);
  EXPECT_EQ(chain.levelCount, 4u);  // 13×6, 6×3, 3×1, 1×1
  EXPECT_EQ(chain.texels.size(), 13u * 6 + 6 * 3 + 3 + 1);
  for (size_t i = 0; i < 13 * 6; ++i) {
    for (size_t c = 0; c < 4; ++c) EXPECT_EQ(chain.texels[i] >> (8 * c) & 255u, image.rgba[i * 4 + c]);
  }
}

TEST(MipTest, EveryLevelKeepsTheMeanOfLinearLight) {
  for (const auto& [width, height] : {std::pair(64u, 64u), std::pair(13u, 6u), std::pair(1u, 37u), std::pair(100u, 3u)}) {
    for (const bool srgb : {true, false}) {
      const scene::MipChain chain = scene::buildMipChain(makeNoise(width, height, srgb));
      glm::dvec4 first(0.0);
      size_t at = 0;
      uint32_t w = width, h = height;
      for (uint32_t level = 0; level < chain.levelCount; ++level) {
        glm::dvec4 mean(0.0);
        for (uint32_t i = 0; i < w * h; ++i) mean += decodeTexel(chain.texels[at + i], srgb);
        mean /= w * h;
        if (level == 0) first = mean;
        // Each texel is rounded to 8 bits: half a step, steepest where sRGB is (2.4/1.055/255).
        for (glm::length_t c = 0; c < 4; ++c) EXPECT_NEAR(mean[c], first[c], 0.0046) << width << "×" << height << " level " << level;
        at += size_t{w} * h;
        w = std::max(w / 2, 1u);
        h = std::max(h / 2, 1u);
      }
      EXPECT_EQ(at, chain.texels.size());
    }
  }
}

TEST(MipTest, BlackAndWhiteMeetInLinearGrey) {
  const std::vector<uint8_t> checker = {0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255};
  EXPECT_EQ(scene::buildMipChain(makeImage(2, 2, checker, true)).texels[4], 0xffbcbcbcu);  // 0.5 encodes to 188
  EXPECT_EQ(scene::buildMipChain(makeImage(2, 2, checker, false)).texels[4], 0xff808080u);
}

TEST(SampleTest, TexelCentresBilinearAndWrap) {
  TextureImage image = makeImage(2, 1, {255, 0, 0, 255, 0, 0, 255, 0}, true);
  const glm::vec4 red(1, 0, 0, 1), blue(0, 0, 1, 0);
  EXPECT_EQ(scene::sampleTexture(image, {0.25f, 0.5f}), red);
  EXPECT_EQ(scene::sampleTexture(image, {0.75f, 0.5f}), blue);
  EXPECT_EQ(scene::sampleTexture(image, {0.5f, 0.5f}), (red + blue) * 0.5f);
  EXPECT_EQ(scene::sampleTexture(image, {0.f, 0.5f}), (red + blue) * 0.5f);  // repeat
  EXPECT_EQ(scene::sampleTexture(image, {-0.75f, 7.5f}), red);
  image.wrapU = shared::kWrapClamp;
  EXPECT_EQ(scene::sampleTexture(image, {-3.f, 0.5f}), red);
  EXPECT_EQ(scene::sampleTexture(image, {9.f, 0.5f}), blue);
  image.wrapU = shared::kWrapMirror;
  EXPECT_EQ(scene::sampleTexture(image, {1.25f, 0.5f}), blue);
  EXPECT_EQ(scene::sampleTexture(image, {-0.25f, 0.5f}), red);
  image.nearest = true;
  EXPECT_EQ(scene::sampleTexture(image, {0.49f, 0.5f}), red);
  EXPECT_EQ(scene::sampleTexture(image, {0.51f, 0.5f}), blue);
}

class TextureImportTest : public ::testing::Test {
 protected:
  static std::vector<uint8_t> makePng(uint32_t width, uint32_t height, const std::vector<uint8_t>& rgba) {
    std::vector<uint8_t> out;
    stbi_write_png_to_func(append, &out, static_cast<int>(width), static_cast<int>(height), 4, rgba.data(), static_cast<int>(width) * 4);
    return out;
  }
  static std::vector<uint8_t> makeJpeg(uint8_t grey) {
    std::vector<uint8_t> out;
    const std::vector<uint8_t> pixels(8 * 8 * 3, grey);
    stbi_write_jpg_to_func(append, &out, 8, 8, 3, pixels.data(), 95);
    return out;
  }
  static void append(void* to, void* data, int size) {
    auto& bytes = *static_cast<std::vector<uint8_t>*>(to);
    bytes.insert(bytes.end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
  }
  /// A triangle with TEXCOORD_0 (0,0) (1,0) (0,1) and TEXCOORD_1 shifted by 10, and one material with the texture infos given.
  TinyGltf makeFile(const json& base, const json& emissive = nullptr) {
    TinyGltf file;
    const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const size_t uv0 = file.addVec2({{0, 0}, {1, 0}, {0, 1}}), uv1 = file.addVec2({{10, 0}, {11, 0}, {10, 1}});
    json material = {{"pbrMetallicRoughness", {{"baseColorTexture", base}}}};
    if (!emissive.is_null()) {
      material["emissiveTexture"] = emissive;
      material["emissiveFactor"] = {1, 1, 1};
    }
    file.json["materials"] = json::array({material});
    file.addNode(
        {{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}}, {"material", 0}})}});
    return file;
  }
  void addImage(TinyGltf& file, const std::vector<uint8_t>& bytes, const json& sampler = nullptr) {
    file.json["images"].push_back({{"bufferView", file.addView(bytes.data(), bytes.size())}, {"mimeType", "image/png"}});
    json texture = {{"source", file.json["images"].size() - 1}};
    if (!sampler.is_null()) {
      file.json["samplers"].push_back(sampler);
      texture["sampler"] = file.json["samplers"].size() - 1;
    }
    file.json["textures"].push_back(texture);
  }
  Scene load(const TinyGltf& file) { return scene::importGltf(folder_.write("scene.gltf", file.gltf())); }
  static bool hasWarning(const Scene& s, const std::string& part) {
    for (const auto& w : s.warnings) {
      if (w.find(part) != std::string::npos) return true;
    }
    return false;
  }
  TempFolder folder_;
};

TEST_F(TextureImportTest, PngAndJpegWithSampler) {
  TinyGltf file = makeFile({{"index", 0}}, {{"index", 1}});
  addImage(file, makePng(2, 1, {10, 20, 30, 40, 50, 60, 70, 80}), {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  addImage(file, makeJpeg(100));
  const Scene s = load(file);
  ASSERT_EQ(s.textures.size(), 2u);
  EXPECT_EQ(s.textures[0].rgba, (std::vector<uint8_t>{10, 20, 30, 40, 50, 60, 70, 80}));
  EXPECT_EQ(s.textures[0].wrapU, shared::kWrapClamp);
  EXPECT_EQ(s.textures[0].wrapV, shared::kWrapMirror);
  EXPECT_TRUE(s.textures[0].nearest);
  EXPECT_EQ(s.textures[1].width, 8u);
  EXPECT_NEAR(s.textures[1].rgba[0], 100, 2);
  EXPECT_EQ(s.textures[1].rgba[3], 255);
  EXPECT_EQ(s.textures[1].wrapU, shared::kWrapRepeat);
  EXPECT_FALSE(s.textures[1].nearest);
  EXPECT_EQ(s.materials[0].baseTexture, 0u);
  EXPECT_EQ(s.materials[0].emissiveTexture, 1u);
  EXPECT_EQ(s.traits().textureCount, 2u);
}

TEST_F(TextureImportTest, TextureCoordinateSetsAndTransforms) {
  const double quarter = std::acos(0.0);
  const json transform = {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}, {"rotation", quarter}, {"scale", {2, 3}}}}};
  TinyGltf file = makeFile({{"index", 0}, {"texCoord", 1}}, {{"index", 0}, {"texCoord", 1}, {"extensions", transform}});
  file.json["materials"][0]["emissiveTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] = 0;
  addImage(file, makePng(1, 1, {1, 2, 3, 4}));
  const Scene s = load(file);
  ASSERT_EQ(s.vertices.size(), 3u);
  EXPECT_EQ(s.vertices[1].uvBase, glm::vec2(11, 0));
  EXPECT_EQ(s.textures.size(), 1u);  // decoded once
  // Counter-clockwise on the page, where v points down: u turns to −v.
  const glm::vec2 expected[3] = {{0.25f, 0.5f}, {0.25f, 0.5f - 2.f}, {0.25f + 3.f, 0.5f}};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(s.vertices[i].uvEmissive.x, expected[i].x, 1e-6f);
    EXPECT_NEAR(s.vertices[i].uvEmissive.y, expected[i].y, 1e-6f);
  }
}

TEST_F(TextureImportTest, MissingAndBrokenImagesAreLeftOut) {
  TinyGltf file = makeFile({{"index", 0}}, {{"index", 0}});
  file.json["images"] = json::array({{{"uri", "gone.png"}}});
  file.json["textures"] = json::array({{{"source", 0}}});
  Scene s = load(file);
  EXPECT_EQ(s.materials[0].baseTexture, shared::kNoTexture);
  EXPECT_TRUE(hasWarning(s, "\"gone.png\") is missing"));
  // The factor alone must not light what the texture would have masked.
  EXPECT_EQ(s.materials[0].emission, glm::vec3(0.f));
  EXPECT_EQ(s.materials[0].flags & shared::kMaterialEmissive, 0u);

  TinyGltf broken = makeFile({{"index", 0}});
  std::vector<uint8_t> png = makePng(4, 4, std::vector<uint8_t>(64, 77));
  png.resize(png.size() / 2);
  addImage(broken, png);
  s = load(broken);
  EXPECT_EQ(s.materials[0].baseTexture, shared::kNoTexture);
  EXPECT_TRUE(hasWarning(s, "no PNG or JPEG"));

  TinyGltf claims = makeFile({{"index", 0}});  // a chunk that claims to hold 2 GiB
  png = makePng(4, 4, std::vector<uint8_t>(64, 77));
  png[33] = 0x7f;
  addImage(claims, png);
  EXPECT_TRUE(hasWarning(load(claims), "no PNG or JPEG"));

  TinyGltf foreign = makeFile({{"index", 0}});
  foreign.json["textures"] = json::array({{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}});
  s = load(foreign);
  EXPECT_TRUE(hasWarning(s, "no PNG or JPEG source"));
}

TEST_F(TextureImportTest, ExternalImageAndErrors) {
  TinyGltf file = makeFile({{"index", 0}});
  const auto png = makePng(1, 1, {9, 8, 7, 6});
  folder_.write("tex ture.png", std::string(png.begin(), png.end()));
  file.json["images"] = json::array({{{"uri", "tex%20ture.png"}}});
  file.json["textures"] = json::array({{{"source", 0}}});
  EXPECT_EQ(load(file).textures.at(0).rgba, (std::vector<uint8_t>{9, 8, 7, 6}));
  const auto failure = [&](auto bend, const std::string& part) {
    TinyGltf bent = file;
    bend(bent.json);
    expectError(catchError([&] { load(bent); }), ErrorCode::BadInput, part);
  };
  failure([](json& j) { j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 3; },
          "baseColorTexture.index: is 3, but the file has 1 textures");
  failure([](json& j) { j["textures"][0]["source"] = 3; }, "textures[0].source: is 3");
  failure([](json& j) { j["textures"][0]["sampler"] = 0; }, "textures[0].sampler: is 0, but the file has 0 samplers");
  failure(
      [](json& j) {
        j["samplers"] = json::array({{{"wrapS", 5}}}), j["textures"][0]["sampler"] = 0;
      },
      "samplers[0].wrapS: is no wrap mode");
  failure([](json& j) { j["images"][0] = {{"bufferView", 77}}; }, "images[0].bufferView: is 77");
  failure([](json& j) { j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 99; }, "texCoord 99");
}

TEST_F(TextureImportTest, UnusableCoordinatesAreReadAsZero) {
  TinyGltf file = makeFile({{"index", 0}});
  addImage(file, makePng(1, 1, {9, 8, 7, 6}));
  const float nan = std::nanf("");
  const size_t uv = file.addVec2({{nan, 0}, {1e30f, 0}, {0.5f, 0.5f}});
  file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
  const Scene s = load(file);
  EXPECT_EQ(s.vertices[0].uvBase, glm::vec2(0));
  EXPECT_EQ(s.vertices[1].uvBase, glm::vec2(0));
  EXPECT_EQ(s.vertices[2].uvBase, glm::vec2(0.5f));
  EXPECT_TRUE(hasWarning(s, "2 × texture coordinates"));
}

TEST_F(TextureImportTest, EmissionIsTheTexturesMean) {
  // Left half of the texture black, right half white; nearest, so the triangle's mean has a closed form.
  TinyGltf file = makeFile({{"index", 0}}, {{"index", 1}});
  addImage(file, makePng(1, 1, {255, 255, 255, 255}));
  addImage(file, makePng(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}), {{"magFilter", 9728}});
  Scene s = load(file);
  // Few texels: points are few too. A larger texture of the same look is integrated finely.
  s.textures[1].width = 64;
  s.textures[1].height = 64;
  s.textures[1].rgba.clear();
  for (uint32_t i = 0; i < 64 * 64; ++i) s.textures[1].rgba.insert(s.textures[1].rgba.end(), 4, i % 64 < 32 ? uint8_t{0} : uint8_t{255});
  const glm::vec3 mean = scene::meanEmission(s, 0);
  EXPECT_NEAR(mean.x, 0.25f, 0.02f);  // the right half of a right triangle is a quarter of it
  // A mask takes away what it cuts.
  s.materials[0].flags |= shared::kMaterialAlphaMask;
  s.materials[0].alphaCutoff = 0.5f;
  EXPECT_NEAR(scene::meanEmission(s, 0).x, 0.25f, 0.02f);
  s.textures[0].rgba = {255, 255, 255, 10};
  EXPECT_EQ(scene::meanEmission(s, 0), glm::vec3(0.f));
}

}  // namespace
}  // namespace radivox::tests
