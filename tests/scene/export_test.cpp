// What exportGlb writes is what importGltf reads, and an independent reader agrees.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "engine/scene/builtin.h"
#include "engine/scene/gltf.h"
#include "tests/gpu/expect_error.h"
#include "tests/scene/tiny_gltf.h"

namespace radivox::tests {
namespace {

using scene::Scene;

class ExportTest : public ::testing::Test {
 protected:
  Scene roundTrip(const Scene& s) {
    scene::exportGlb(s, folder_.path("out.glb"));
    return scene::importGltf(folder_.path("out.glb"));
  }
  TempFolder folder_;
};

/// Everything but the numbering of vertices.
void expectSame(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.triangleCount(), b.triangleCount());
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.triangleMaterials, b.triangleMaterials);
  for (size_t i = 0; i < a.indices.size(); ++i) {
    const auto &va = a.vertices[a.indices[i]], &vb = b.vertices[b.indices[i]];
    ASSERT_EQ(va.position, vb.position) << "corner " << i;
    ASSERT_LT(glm::length(va.normal - vb.normal), 2e-7f) << "corner " << i;
    ASSERT_EQ(va.uvBase, vb.uvBase);
    ASSERT_EQ(va.uvEmissive, vb.uvEmissive);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  EXPECT_EQ(a.materialNames, b.materialNames);
  for (size_t i = 0; i < a.materials.size(); ++i) {
    const auto &ma = a.materials[i], &mb = b.materials[i];
    EXPECT_EQ(ma.albedo, mb.albedo);
    EXPECT_EQ(ma.alpha, mb.alpha);
    EXPECT_EQ(ma.emission, mb.emission);
    EXPECT_EQ(ma.alphaCutoff, mb.alphaCutoff);
    EXPECT_EQ(ma.baseTexture, mb.baseTexture);
    EXPECT_EQ(ma.emissiveTexture, mb.emissiveTexture);
    EXPECT_EQ(ma.flags, mb.flags);
  }
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i].rgba, b.textures[i].rgba);
    EXPECT_EQ(a.textures[i].wrapU, b.textures[i].wrapU);
    EXPECT_EQ(a.textures[i].wrapV, b.textures[i].wrapV);
    EXPECT_EQ(a.textures[i].nearest, b.textures[i].nearest);
  }
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (size_t i = 0; i < a.lights.size(); ++i) {
    const auto &la = a.lights[i], &lb = b.lights[i];
    EXPECT_EQ(la.name, lb.name);
    EXPECT_EQ(la.type, lb.type);
    if (la.type != shared::kLightDirectional) {
      EXPECT_EQ(la.position, lb.position);
    }
    if (la.type != shared::kLightPoint) {
      EXPECT_LT(glm::length(la.direction - lb.direction), 1e-6f);
    }
    EXPECT_EQ(la.intensity, lb.intensity);
    EXPECT_EQ(la.range, lb.range);
    EXPECT_EQ(la.innerConeAngle, lb.innerConeAngle);
    EXPECT_EQ(la.outerConeAngle, lb.outerConeAngle);
  }
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (size_t i = 0; i < a.cameras.size(); ++i) {
    const auto &ca = a.cameras[i], &cb = b.cameras[i];
    EXPECT_EQ(ca.name, cb.name);
    EXPECT_EQ(ca.position, cb.position);
    EXPECT_GT(std::abs(glm::dot(ca.orientation, cb.orientation)), 1 - 1e-6f);
    EXPECT_EQ(ca.orthographic, cb.orthographic);
    EXPECT_EQ(ca.yfov, cb.yfov);
    EXPECT_EQ(ca.ymag, cb.ymag);
    EXPECT_FLOAT_EQ(ca.znear, cb.znear);
  }
  EXPECT_EQ(a.skyRadiance, b.skyRadiance);
}

TEST_F(ExportTest, EveryBuiltinSceneComesBack) {
  for (const auto& info : scene::builtinScenes()) {
    SCOPED_TRACE(info.name);
    const Scene s = scene::makeBuiltin(info.name);
    expectSame(s, roundTrip(s));
  }
  expectSame(scene::loadScene("builtin:cornell_point?offset=1e6"), roundTrip(scene::loadScene("builtin:cornell_point?offset=1e6")));
}

/// A scene with everything a Scene can hold.
Scene makeRichScene() {
  Scene s = scene::makeBuiltin("cornell_point");
  for (uint32_t k = 0; k < 2; ++k) {
    scene::TextureImage image;
    image.width = 3 + k;
    image.height = 2;
    for (uint32_t i = 0; i < image.width * 8; ++i) image.rgba.push_back(static_cast<uint8_t>(i * 7 + k));
    image.wrapU = k == 0 ? shared::kWrapMirror : shared::kWrapClamp;
    image.nearest = k == 1;
    s.textures.push_back(image);
  }
  for (auto& vertex : s.vertices) {
    vertex.uvBase = glm::vec2(vertex.position) * 0.3f;
    vertex.uvEmissive = glm::vec2(vertex.position.z, vertex.position.x) * 0.7f;
  }
  s.materials[0].baseTexture = 0;
  s.materials[0].emissiveTexture = 1;
  s.materials[0].emission = {0.1f, 3.7f, 0.9f};
  s.materials[0].flags |= shared::kMaterialEmissive | shared::kMaterialAlphaMask | shared::kMaterialDoubleSided;
  s.materials[0].alphaCutoff = 0.3f;
  s.materials[1].emissiveTexture = 1;
  s.materials[1].emission = {0.1f, 0.2f, 0.3f};
  s.materials[1].flags |= shared::kMaterialEmissive;
  scene::PunctualLight spot;
  spot.name = "spot";
  spot.type = shared::kLightSpot;
  spot.position = {1, 2, 3};
  spot.direction = glm::normalize(glm::vec3(1, -2, 0.5f));
  spot.intensity = {5.3f, 0, 0.7f};
  spot.range = 9;
  spot.innerConeAngle = 0.3f;
  spot.outerConeAngle = 0.7f;
  s.lights.push_back(spot);
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.intensity = {1, 2, 3};
  s.lights.push_back(sun);
  scene::CameraDescription flat;
  flat.name = "flat";
  flat.orthographic = true;
  flat.yfov = 0.8f;
  flat.ymag = 2.5f;
  s.cameras.push_back(flat);
  s.skyRadiance = {0.4f, 0.5f, 0.6f};
  // Vertices of materials without that texture read no coordinates.
  for (size_t t = 0; t < s.triangleCount(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      auto& vertex = s.vertices[s.indices[t * 3 + k]];
      if (s.triangleMaterials[t] != 0) vertex.uvBase = glm::vec2(0);
      if (s.triangleMaterials[t] > 1) vertex.uvEmissive = glm::vec2(0);
    }
  }
  return s;
}

TEST_F(ExportTest, EveryPropertyComesBack) {
  const Scene s = makeRichScene();
  expectSame(s, roundTrip(s));
}

TEST_F(ExportTest, WritingWhatWasReadGivesTheSameGeometryBytes) {
  const Scene once = roundTrip(scene::makeBuiltin("sphere", {{"rings", "5"}}));
  scene::exportGlb(once, folder_.path("a.glb"));
  const Scene twice = scene::importGltf(folder_.path("a.glb"));
  EXPECT_EQ(once.indices, twice.indices);
  ASSERT_EQ(once.vertices.size(), twice.vertices.size());
  for (size_t i = 0; i < once.vertices.size(); ++i) EXPECT_EQ(once.vertices[i].position, twice.vertices[i].position);
}

TEST_F(ExportTest, AnIndependentReaderAgrees) {
  const Scene s = makeRichScene();
  scene::exportGlb(s, folder_.path("out.glb"));
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string errors, warnings;
  ASSERT_TRUE(loader.LoadBinaryFromFile(&model, &errors, &warnings, folder_.path("out.glb"))) << errors;
  EXPECT_EQ(errors, "");
  EXPECT_EQ(warnings, "");
  ASSERT_EQ(model.meshes.size(), 1u);
  size_t triangles = 0;
  glm::dvec3 sum(0.0), expected(0.0);
  for (const auto& primitive : model.meshes[0].primitives) {
    const auto& indices = model.accessors[static_cast<size_t>(primitive.indices)];
    const auto& positions = model.accessors[static_cast<size_t>(primitive.attributes.at("POSITION"))];
    const auto at = [&](const tinygltf::Accessor& a) {
      const auto& view = model.bufferViews[static_cast<size_t>(a.bufferView)];
      return model.buffers[static_cast<size_t>(view.buffer)].data.data() + view.byteOffset + a.byteOffset;
    };
    const auto* index = reinterpret_cast<const uint32_t*>(at(indices));
    const auto* position = reinterpret_cast<const float*>(at(positions));
    for (size_t i = 0; i < indices.count; ++i) {
      for (glm::length_t c = 0; c < 3; ++c) {
        const float v = position[index[i] * 3 + static_cast<uint32_t>(c)];
        sum[c] += static_cast<double>(v) * static_cast<double>(i + 1 + triangles * 3);
        EXPECT_GE(v, positions.minValues[static_cast<size_t>(c)]);
        EXPECT_LE(v, positions.maxValues[static_cast<size_t>(c)]);
      }
    }
    triangles += indices.count / 3;
  }
  EXPECT_EQ(triangles, s.triangleCount());
  for (size_t i = 0; i < s.indices.size(); ++i) expected += glm::dvec3(s.vertices[s.indices[i]].position) * static_cast<double>(i + 1);
  for (glm::length_t c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], expected[c], 1e-9 * std::abs(expected[c]));
  EXPECT_EQ(model.lights.size(), 3u);
  EXPECT_EQ(model.lights[1].type, "spot");
  EXPECT_NEAR(model.lights[1].spot.outerConeAngle, 0.7, 1e-6);
  EXPECT_EQ(model.cameras.size(), 2u);
  EXPECT_EQ(model.images.size(), 2u);
  EXPECT_EQ(model.images[0].image, s.textures[0].rgba);
  EXPECT_NEAR(model.materials[0].alphaCutoff, 0.3, 1e-6);
}

TEST_F(ExportTest, LeavesNothingBehindWhenItCannotWrite) {
  expectError(catchError([&] { scene::exportGlb(scene::makeBuiltin("box"), folder_.path("no/such/folder.glb")); }), ErrorCode::BadInput,
              "folder");
  scene::exportGlb(scene::makeBuiltin("box"), folder_.path("a.glb"));
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path(""))) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 1u);
}

}  // namespace
}  // namespace radivox::tests
