// glTF files that tinygltf alone would refuse though they are legal, read wrongly, or read beyond their end.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "engine/scene/gltf.h"
#include "tests/gpu/expect_error.h"
#include "tests/scene/tiny_gltf.h"

namespace radivox::tests {
namespace {

using nlohmann::json;
using scene::Scene;

class GltfGapsTest : public ::testing::Test {
 protected:
  GltfGapsTest() {
    positions_ = file_.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    mesh_ = file_.addMesh({{"attributes", {{"POSITION", positions_}}}});
    file_.addNode({{"mesh", mesh_}});
  }
  Scene load(const std::string& bytes, const std::string& name = "scene.gltf") { return scene::importGltf(folder_.write(name, bytes)); }
  void expectFailure(const std::string& bytes, const std::string& part) {
    expectError(catchError([&] { load(bytes); }), ErrorCode::BadInput, part);
  }
  static bool hasWarning(const Scene& s, const std::string& part) {
    for (const auto& w : s.warnings) {
      if (w.find(part) != std::string::npos) return true;
    }
    return false;
  }
  static std::string word(size_t value) {
    const auto w = static_cast<uint32_t>(value);
    return {reinterpret_cast<const char*>(&w), 4};
  }
  /// A GLB of the file's JSON and these chunks.
  std::string glbOf(const std::vector<std::pair<std::string, std::string>>& chunks) {
    json root = file_.json;
    root["buffers"] = {{{"byteLength", file_.binary.size()}}};
    std::string text = root.dump(), body;
    text.append((4 - text.size() % 4) % 4, ' ');
    body = word(text.size()) + "JSON" + text;
    for (const auto& [type, bytes] : chunks) body += word(bytes.size()) + type + bytes;
    return "glTF" + word(2) + word(12 + body.size()) + body;
  }
  TinyGltf file_;
  size_t positions_ = 0, mesh_ = 0;
  TempFolder folder_;
};

TEST_F(GltfGapsTest, BuffersLongerThanDeclared) {
  file_.binary.resize(36);
  const std::string uri = "data:application/octet-stream;base64," + encodeBase64(file_.binary + "and more");
  file_.json["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
  EXPECT_EQ(load(file_.gltf()).triangleCount(), 1u);
  folder_.write("longer.bin", file_.binary + "and more");
  file_.json["buffers"][0]["uri"] = "longer.bin";
  EXPECT_EQ(load(file_.gltf()).triangleCount(), 1u);
}

TEST_F(GltfGapsTest, FileNamesAreWhatTheySay) {
  for (const char* name : {"a+b.bin", "100%.bin", "sub/c.bin"}) {
    std::filesystem::create_directories(std::filesystem::path(folder_.path(name)).parent_path());
    folder_.write(name, file_.binary);
  }
  for (const char* uri : {"a+b.bin", "a%2bb.bin", "100%25.bin", "sub/c.bin", "sub/../a+b.bin"})
    EXPECT_EQ(load(file_.gltf(uri)).triangleCount(), 1u) << uri;
  expectFailure(file_.gltf(folder_.path("a+b.bin")), "is not a file beside this one");
  expectFailure(file_.gltf("100%.bin"), "is no file name");
  expectFailure(file_.gltf("a%00.bin"), "is no file name");
}

TEST_F(GltfGapsTest, AnyKindOfDataUri) {
  for (const char* kind : {"data:;base64,", "data:application/x-made-up;charset=none;base64,"})
    EXPECT_EQ(load(file_.gltf(kind + encodeBase64(file_.binary))).triangleCount(), 1u);
  std::string text = encodeBase64(file_.binary);
  text[10] = '#';  // where tinygltf's decoder would stop without a word
  expectFailure(file_.gltf("data:application/octet-stream;base64," + text), "buffers[0].uri: holds broken base64");
}

TEST_F(GltfGapsTest, ChunksOfGlb) {
  EXPECT_EQ(load(glbOf({{{"BIN\0", 4}, file_.binary}}), "a.glb").triangleCount(), 1u);
  EXPECT_EQ(load(glbOf({{{"BIN\0", 4}, file_.binary + "x"}}), "b.glb").triangleCount(), 1u);              // not a multiple of 4
  EXPECT_EQ(load(glbOf({{"ACME", "what"}, {{"BIN\0", 4}, file_.binary}}), "c.glb").triangleCount(), 1u);  // after another
  EXPECT_EQ(load(glbOf({{{"BIN\0", 4}, file_.binary}, {"ACME", "what"}}), "d.glb").triangleCount(), 1u);  // before another
  EXPECT_EQ(load(glbOf({{{"BIN\0", 4}, file_.binary}}) + "tail", "e.glb").warnings.front().find("4 bytes after"), 0u);
  // The last chunk claims 8 bytes more than there are, which tinygltf would read.
  std::string bytes = glbOf({{{"BIN\0", 4}, file_.binary}});
  const size_t at = bytes.size() - file_.binary.size() - 8;
  bytes.replace(at, 4, word(file_.binary.size() + 8));
  expectFailure(bytes, "byte " + std::to_string(at) + ": a GLB chunk of 44 bytes is longer than the file");
}

TEST_F(GltfGapsTest, NumbersAreTakenAsMeant) {
  file_.json["nodes"][0]["mesh"] = 0.0;  // whole all the same
  file_.json["materials"] = json::array(
      {{{"emissiveFactor", {1, 1, 1}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5000000000}}}}}}});
  file_.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_EQ(load(file_.gltf()).materials[0].emission, glm::vec3(5e9f));  // beyond an int
  file_.json["nodes"][0]["mesh"] = 4294967296;
  expectFailure(file_.gltf(), "nodes[0].mesh: is 4294967296, but the file has 1 meshes");
  file_.json["nodes"][0]["mesh"] = 0.5;
  expectFailure(file_.gltf(), "nodes[0].mesh: is 0.5, should be a whole number");
}

TEST_F(GltfGapsTest, PrimitivesAreNotDroppedInSilence) {
  file_.json["meshes"][0]["primitives"][0]["attributes"]["_OWN"] = "x";
  expectFailure(file_.gltf(), "meshes[0].primitives[0].attributes._OWN: should be a number, is string");
  file_.json["meshes"][0]["primitives"][0]["attributes"].erase("_OWN");
  file_.json["bufferViews"][0]["byteStride"] = 13;
  expectFailure(file_.gltf(), "bufferViews[0].byteStride: is 13, should be a multiple of 4 up to 252");
}

TEST_F(GltfGapsTest, LensesMayLackNumbers) {
  file_.json["cameras"] = json::array(
      {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}}}}, {{"type", "orthographic"}, {"orthographic", {{"ymag", 2}}}}});
  file_.addNode({{"camera", 0}});
  file_.addNode({{"camera", 1}});
  const Scene s = load(file_.gltf());
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_FLOAT_EQ(s.cameras[0].yfov, 0.5f);
  EXPECT_FLOAT_EQ(s.cameras[1].ymag, 2.f);
  file_.json["cameras"][0].erase("perspective");
  expectFailure(file_.gltf(), "cameras[0].perspective.yfov: is 0");
}

TEST_F(GltfGapsTest, WhatIsNotReadIsNoHindrance) {
  // Images no material uses: neither missing nor broken ones matter. Nor do animations, whatever they hold.
  file_.json["images"] = json::array({{{"uri", "gone.png"}}, {{"uri", "https://example.org/a.png"}}, {{"bufferView", 0}}, json::object()});
  file_.json["textures"] = json::array({{{"source", 0}}, {{"source", 3}}});
  file_.json["materials"] = json::array({{{"normalTexture", {{"index", 0}}}}});
  file_.json["animations"] = "none";
  const Scene s = load(file_.gltf());
  EXPECT_TRUE(s.textures.empty());
  EXPECT_FALSE(hasWarning(s, "gone.png"));
}

TEST_F(GltfGapsTest, ImagesThatCannotBeReadLeaveTheirTextureWhite) {
  const size_t uv = file_.addVec2({{0, 0}, {1, 0}, {0, 1}});
  file_.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
  file_.json["meshes"][0]["primitives"][0]["material"] = 0;
  file_.json["textures"] = json::array({{{"source", 0}}});
  file_.json["materials"] =
      json::array({{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"baseColorTexture", {{"index", 0}}}}}}});
  folder_.write("empty.png", "");
  for (const auto& [image, part] :
       std::vector<std::pair<json, std::string>>{{{{"uri", "gone.png"}}, "images[0] (\"gone.png\") is missing or empty"},
                                                 {{{"uri", "empty.png"}}, "images[0] (\"empty.png\") is missing or empty"},
                                                 {{{"uri", "https://example.org/a.png"}}, "is not a file beside this one"},
                                                 {{{"uri", "data:image/png;base64,%%%"}}, "images[0] (the data URI) holds broken base64"},
                                                 {{{"uri", "data:image/png;base64,AAAA"}}, "is no PNG or JPEG"},
                                                 {json::object(), "images[0] has neither a uri nor a bufferView"}}) {
    file_.json["images"] = json::array({image});
    const Scene s = load(file_.gltf());
    EXPECT_TRUE(hasWarning(s, part)) << part << " in " << (s.warnings.empty() ? "nothing" : s.warnings.front());
    EXPECT_EQ(s.materials[0].baseTexture, shared::kNoTexture);
    EXPECT_EQ(s.materials[0].albedo, glm::vec3(0.5f));
  }
  // An image's range is read by tinygltf itself, so it is an error where it is wrong.
  file_.json["images"] = json::array({{{"bufferView", 0}}});
  file_.json["bufferViews"][0]["byteOffset"] = 1000000;
  expectFailure(file_.gltf(), "images[0]: its bytes end beyond the buffer of bufferViews[0]");
}

TEST_F(GltfGapsTest, DeepExtrasAreRefused) {
  std::string deep = "1";
  for (int i = 0; i < 200; ++i) deep = "[" + deep + "]";
  file_.json["nodes"][0]["extras"] = json::parse(deep);
  expectFailure(file_.gltf(), "nests deeper than 128 levels");
  file_.json["nodes"][0]["extras"] = std::string(500, '[') + "\\\"[[";  // brackets in strings are none
  EXPECT_EQ(load(file_.gltf()).triangleCount(), 1u);
}

}  // namespace
}  // namespace radivox::tests
