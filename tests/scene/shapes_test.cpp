// glTF import: shapes that are not plain meshes: morph targets, skins, vertex colours, compressed data.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/gltf.h"
#include "tests/gpu/expect_error.h"
#include "tests/scene/tiny_gltf.h"

#ifdef RADIVOX_WITH_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace radivox::tests {
namespace {

using nlohmann::json;
using scene::Scene;

class ShapesTest : public ::testing::Test {
 protected:
  Scene load(const TinyGltf& file) { return scene::importGltf(folder_.write("scene.gltf", file.gltf())); }
  void expectFailure(const TinyGltf& file, const std::string& part) {
    expectError(catchError([&] { load(file); }), ErrorCode::BadInput, part);
  }
  static glm::vec3 corner(const Scene& s, size_t triangle, size_t k) { return s.vertices[s.indices[triangle * 3 + k]].position; }
  static const shared::Material& materialOf(const Scene& s, size_t triangle) { return s.materials[s.triangleMaterials[triangle]]; }
  static std::string allWarnings(const Scene& s) {
    std::string out;
    for (const auto& w : s.warnings) out += w + "\n";
    return out;
  }
  TempFolder folder_;
};

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
  EXPECT_LE(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

TEST_F(ShapesTest, MorphTargetsAtTheirDefaultWeights) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), normals = file.addVec3({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const size_t up = file.addVec3({{0, 0, 0}, {0, 0, 4}, {0, 0, 0}}), right = file.addVec3({{2, 0, 0}, {2, 0, 0}, {2, 0, 0}});
  const size_t tilt = file.addVec3({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  const json targets = {{{"POSITION", up}}, {{"POSITION", right}, {"NORMAL", tilt}}};
  const size_t mesh = file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"targets", targets}});
  file.addNode({{"mesh", mesh}});  // no weights: the base shape
  EXPECT_EQ(corner(load(file), 0, 1), glm::vec3(1, 0, 0));
  file.json["meshes"][mesh]["weights"] = {0.25, 0};
  file.addNode({{"mesh", mesh}, {"weights", {0, 1}}});
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 2u);
  EXPECT_EQ(corner(s, 0, 1), glm::vec3(1, 0, 1));  // the mesh's own
  EXPECT_EQ(corner(s, 1, 1), glm::vec3(3, 0, 0));  // the node's
  expectNear(s.vertices[s.indices[3]].normal, glm::normalize(glm::vec3(1, 0, 1)));
  EXPECT_EQ(allWarnings(s).find("morph"), std::string::npos);
  file.json["accessors"][up]["count"] = 2;
  expectFailure(file, "meshes[0].primitives[0].targets[0].POSITION: has 2 entries, POSITION has 3");
}

TEST_F(ShapesTest, SparseMorphTargets) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const uint8_t index = 2;
  const glm::vec3 offset(0, 1, 0);
  const size_t indices = file.addView(&index, 1), values = file.addView(&offset, 12);
  file.json["accessors"].push_back(
      {{"componentType", 5126},
       {"type", "VEC3"},
       {"count", 3},
       {"sparse", {{"count", 1}, {"indices", {{"bufferView", indices}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}}}});
  const size_t mesh = file.addMesh({{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", 1}}}}});
  file.json["meshes"][mesh]["weights"] = {3};
  file.addNode({{"mesh", mesh}});
  EXPECT_EQ(corner(load(file), 0, 2), glm::vec3(0, 4, 0));
}

class SkinTest : public ShapesTest {
 protected:
  /// A triangle whose corners follow joint 0, joint 1, and both by halves. Joint 1 is a child of joint 0. The mesh's node stands
  /// somewhere else, which must not matter.
  SkinTest() {
    const size_t positions = file_.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), normals = file_.addVec3({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    const size_t joints = file_.addAccessor(std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 5121, "VEC4", 3);
    const size_t weights = file_.addAccessor(std::vector<uint8_t>{255, 0, 0, 0, 100, 0, 0, 0, 80, 80, 0, 0}, 5121, "VEC4", 3);
    file_.json["accessors"][weights]["normalized"] = true;  // sums other than 1 are scaled to it
    const glm::mat4 one(1.f), down = [] {
      glm::mat4 m(1.f);
      m[3] = glm::vec4(0, 0, -1, 1);
      return m;
    }();
    inverse_ = file_.addAccessor(std::vector<glm::mat4>{one, down}, 5126, "MAT4", 2);
    mesh_ = file_.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
    file_.addNode({{"mesh", mesh_}, {"skin", 0}, {"translation", {500, 0, 0}}});
    file_.addNode({{"translation", {0, 0, 3}}, {"children", {2}}});
    file_.json["nodes"].push_back({{"translation", {0, 0, 10}}});
    file_.json["skins"] = json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", inverse_}}});
  }
  TinyGltf file_;
  size_t mesh_ = 0, inverse_ = 0;
};

TEST_F(SkinTest, JointsAtRestMoveTheVertices) {
  const Scene s = load(file_);
  ASSERT_EQ(s.triangleCount(), 1u);
  expectNear(corner(s, 0, 0), {0, 0, 3});     // joint 0
  expectNear(corner(s, 0, 1), {1, 0, 12});    // joint 1: 3 + 10 − 1
  expectNear(corner(s, 0, 2), {0, 1, 7.5f});  // half and half
  for (const auto& vertex : s.vertices) expectNear(vertex.normal, {0, 0, 1});
  EXPECT_EQ(allWarnings(s).find("skin"), std::string::npos) << allWarnings(s);
  file_.json["skins"][0].erase("inverseBindMatrices");
  expectNear(corner(load(file_), 0, 1), {1, 0, 13});
}

TEST_F(SkinTest, MirroringJointsKeepFrontsAndNormalsTogether) {
  file_.json["nodes"][1]["scale"] = {1, -1, 1};
  const Scene s = load(file_);
  const glm::vec3 geometric = glm::cross(corner(s, 0, 1) - corner(s, 0, 0), corner(s, 0, 2) - corner(s, 0, 0));
  EXPECT_GT(glm::dot(geometric, s.vertices[0].normal), 0.f);
  EXPECT_GT(s.vertices[0].normal.z, 0.f);
}

TEST_F(SkinTest, WhatCannotBeSkinned) {
  TinyGltf file = file_;
  file.json["skins"][0]["joints"] = {1};
  expectFailure(file, "meshes[0].primitives[0].attributes.JOINTS_0: vertex 1 follows joint 1, but the skin has 1");
  file = file_;
  file.json["accessors"][inverse_]["count"] = 1;
  expectFailure(file, "skins[0].inverseBindMatrices: has 1 matrices for 2 joints");
  file = file_;
  file.json["nodes"][0]["skin"] = 1;
  expectFailure(file, "nodes[0].skin: is 1, but the file has 1 skins");
  file = file_;
  file.json["skins"][0].erase("joints");
  expectFailure(file, "skins[0]: required property \"joints\"");
  file = file_;
  file.json["scenes"][0]["nodes"] = {0};  // the joints are not in the scene: the mesh stays at its node
  const Scene s = load(file);
  EXPECT_EQ(corner(s, 0, 0), glm::vec3(500, 0, 0));
  EXPECT_NE(allWarnings(s).find("joints are not in the scene"), std::string::npos);
}

class ColorTest : public ShapesTest {
 protected:
  /// Two triangles with a corner's colours each, over a half-grey material.
  template <class T>
  Scene loadColors(const std::vector<T>& colors, uint32_t type, const std::string& shape) {
    TinyGltf file;
    file.json["materials"] = json::array({{{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 0.5}}}}}});
    const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    const size_t color = file.addAccessor(colors, type, shape, 6);
    if (type != 5126) file.json["accessors"][color]["normalized"] = true;
    file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", color}}}, {"material", 0}})}});
    return load(file);
  }
};

TEST_F(ColorTest, TrianglesOfOneColorAreExact) {
  const glm::vec3 a(0.2f, 0.4f, 1), b(1);
  const Scene s = loadColors(std::vector<glm::vec3>{a, a, a, b, b, b}, 5126, "VEC3");
  ASSERT_EQ(s.triangleCount(), 2u);
  EXPECT_EQ(materialOf(s, 0).albedo, a * 0.5f);
  EXPECT_EQ(s.triangleMaterials[1], 0u);  // white: the material as it is
  EXPECT_EQ(s.materials.size(), 2u);
  EXPECT_EQ(s.materialNames[1], "paint, tint 1");
  EXPECT_EQ(allWarnings(s).find("vertex colours"), std::string::npos) << allWarnings(s);
}

TEST_F(ColorTest, BytesAndAlpha) {
  const std::vector<uint8_t> colors = {51, 0, 255, 102, 51, 0, 255, 102, 51, 0, 255, 102,
                                       51, 0, 255, 102, 51, 0, 255, 102, 51, 0, 255, 102};
  const Scene s = loadColors(colors, 5121, "VEC4");
  EXPECT_EQ(s.triangleMaterials[0], s.triangleMaterials[1]);  // equal colours share a material
  expectNear(materialOf(s, 0).albedo, {0.1f, 0, 0.5f});
  EXPECT_FLOAT_EQ(materialOf(s, 0).alpha, 0.2f);
}

TEST_F(ColorTest, VaryingColorsKeepTheMean) {
  const glm::vec3 white(1);
  const Scene s = loadColors(std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, white, white, {1, 1, 0.25f}}, 5126, "VEC3");
  expectNear(materialOf(s, 0).albedo, glm::vec3(0.5f / 3), 0.5f / 256);
  expectNear(materialOf(s, 1).albedo, {0.5f, 0.5f, 0.375f}, 0.5f / 256);
  EXPECT_NE(allWarnings(s).find("2 × triangles whose vertex colours differ"), std::string::npos) << allWarnings(s);
}

TEST_F(ColorTest, ManyColorsShareMaterials) {
  TinyGltf file;
  std::vector<glm::vec3> positions, colors;
  for (int i = 0; i < 6000; ++i) {
    const auto x = static_cast<float>(i);
    positions.insert(positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    colors.insert(colors.end(), 3, glm::vec3(x / 6000, 1 - x / 6000, 0.5f));
  }
  const size_t position = file.addVec3(positions), color = file.addVec3(colors);
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", position}, {"COLOR_0", color}}}})}});
  const Scene s = load(file);
  EXPECT_LT(s.materials.size(), 4096u + 64);
  for (size_t t = 0; t < 6000; ++t) expectNear(materialOf(s, t).albedo, 0.999f * colors[t * 3], t < 4096 ? 1e-6f : 0.06f);
  EXPECT_NE(allWarnings(s).find("vertex colours beyond the first 4096"), std::string::npos);
}

TEST_F(ShapesTest, VariantsAreNoNews) {
  TinyGltf file;
  file.addTriangle();
  file.json["extensionsUsed"] = {"KHR_materials_variants"};
  file.json["extensionsRequired"] = {"KHR_materials_variants"};
  file.json["extensions"]["KHR_materials_variants"]["variants"] = json::array({{{"name", "red"}}});
  EXPECT_EQ(load(file).warnings, (std::vector<std::string>{"the scene has no light: no lights, no emissive surface, no sky"}));
}

/// A strip of squares in the plane z = 0.
struct Strip {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<uint32_t> indices;
  Strip() {
    for (uint32_t i = 0; i < 40; ++i) {
      const auto x = static_cast<float>(i / 2);
      positions.push_back({x, i % 2, 0});
      normals.push_back({0, 0, 1});
    }
    for (uint32_t i = 0; i + 3 < 40; i += 2) indices.insert(indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
  }
};

#ifdef RADIVOX_WITH_MESHOPTIMIZER
class MeshoptTest : public ShapesTest {
 protected:
  /// The strip with all its views compressed, beside a fallback buffer without bytes.
  TinyGltf makeFile() {
    TinyGltf file;
    const Strip strip;
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(40, 12));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), strip.positions.data(), 40, 12));
    addCompressed(file, bytes, 40, 12, "ATTRIBUTES", "NONE");
    std::vector<float> unit;
    for (const auto& n : strip.normals) unit.insert(unit.end(), {n.x, n.y, n.z, 0});
    std::vector<unsigned char> filtered(40 * 4);
    meshopt_encodeFilterOct(filtered.data(), 40, 4, 8, unit.data());
    bytes.resize(meshopt_encodeVertexBufferBound(40, 4));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), filtered.data(), 40, 4));
    addCompressed(file, bytes, 40, 4, "ATTRIBUTES", "OCTAHEDRAL");
    bytes.resize(meshopt_encodeIndexBufferBound(strip.indices.size(), 40));
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), strip.indices.data(), strip.indices.size()));
    addCompressed(file, bytes, strip.indices.size(), 2, "TRIANGLES", "NONE");
    bytes.resize(meshopt_encodeIndexSequenceBound(strip.indices.size(), 40));
    bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), strip.indices.data(), strip.indices.size()));
    addCompressed(file, bytes, strip.indices.size(), 4, "INDICES", "NONE");
    const size_t count = strip.indices.size();
    file.json["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 40}},
                              {{"bufferView", 1}, {"componentType", 5120}, {"type", "VEC3"}, {"count", 40}, {"normalized", true}},
                              {{"bufferView", 2}, {"componentType", 5123}, {"type", "SCALAR"}, {"count", count}},
                              {{"bufferView", 3}, {"componentType", 5125}, {"type", "SCALAR"}, {"count", count}}};
    file.json["bufferViews"][1]["byteStride"] = 4;
    for (const int indices : {2, 3})
      file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", indices}})}});
    file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
    file.json["buffers"] = {{{"byteLength", file.binary.size()}, {"uri", "data:;base64," + encodeBase64(file.binary)}},
                            {{"byteLength", 4096}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    return file;
  }
  static void addCompressed(TinyGltf& file, const std::vector<unsigned char>& bytes, size_t count, size_t stride, const char* mode,
                            const char* filter) {
    const size_t view = file.addView(bytes.data(), bytes.size());
    json compressed = file.json["bufferViews"][view];
    compressed.update({{"count", count}, {"byteStride", stride}, {"mode", mode}, {"filter", filter}});
    file.json["bufferViews"][view] = {
        {"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", compressed}}}};
  }
};

TEST_F(MeshoptTest, ComesOutAsItWentIn) {
  const Scene s = load(makeFile());
  const Strip strip;
  ASSERT_EQ(s.triangleCount(), 2 * strip.indices.size() / 3);
  // The index codec may turn a triangle's corners, so sums are compared.
  for (size_t t = 0; t < s.triangleCount(); ++t) {
    const uint32_t* c = strip.indices.data() + t % (strip.indices.size() / 3) * 3;
    expectNear(corner(s, t, 0) + corner(s, t, 1) + corner(s, t, 2), strip.positions[c[0]] + strip.positions[c[1]] + strip.positions[c[2]]);
  }
  for (const auto& vertex : s.vertices) expectNear(vertex.normal, {0, 0, 1}, 1e-2f);
}

TEST_F(MeshoptTest, BrokenDataIsRefused) {
  const auto bent = [&](size_t view, const char* key, const json& value) {
    TinyGltf file = makeFile();
    file.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
    return file;
  };
  expectFailure(bent(0, "byteLength", 20), "bufferViews[0]: its compressed data is broken");
  expectFailure(bent(0, "count", 1000000000), "bufferViews[0]: its compressed data is broken");
  expectFailure(bent(0, "byteStride", 10), "bufferViews[0]: its compressed data is broken");
  expectFailure(bent(2, "count", 7), "bufferViews[2]: its compressed data is broken");
  expectFailure(bent(1, "filter", "QUATERNION"), "bufferViews[1]: its compressed data is broken");
  expectFailure(bent(1, "filter", "ROUND"), "filter: is \"ROUND\", should be one of");
  expectFailure(bent(0, "byteOffset", 1000000), "end beyond buffers[0]");
  expectFailure(bent(0, "buffer", 7), "EXT_meshopt_compression.buffer: is 7");
  TinyGltf fallback = makeFile();
  fallback.json["bufferViews"][0].erase("extensions");
  expectFailure(fallback, "bufferViews[0]: bytes 0 + 480 end beyond buffers[1]");
}
#endif

#ifdef RADIVOX_WITH_DRACO
class DracoTest : public ShapesTest {
 protected:
  /// The strip, positions and normals, encoded with Draco 1.5.5 (sequential, not quantized). Kept as a file: libdraco's encoder brings
  /// another tinygltf, which must not meet the one that reads what is exported.
  static TinyGltf makeFile() {
    TinyGltf file;
    file.json = json::parse(readBytes(std::string(RADIVOX_SOURCE_DIR) + "/tests/fuzz/import/seed_draco.gltf"));
    const std::string uri = file.json["buffers"][0]["uri"], digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t bits = 0, bitCount = 0;
    for (size_t i = uri.find(',') + 1; i < uri.size() && uri[i] != '='; ++i) {
      bits = bits << 6 | static_cast<uint32_t>(digits.find(uri[i]));
      bitCount += 6;
      if (bitCount >= 8) file.binary.push_back(static_cast<char>(bits >> (bitCount -= 8)));
    }
    file.json.erase("buffers");
    return file;
  }
};

TEST_F(DracoTest, ComesOutAsItWentIn) {
  const Scene s = load(makeFile());
  const Strip strip;
  ASSERT_EQ(s.triangleCount(), strip.indices.size() / 3);
  for (size_t i = 0; i < strip.indices.size(); ++i) expectNear(corner(s, i / 3, i % 3), strip.positions[strip.indices[i]]);
  for (const auto& vertex : s.vertices) expectNear(vertex.normal, {0, 0, 1});
}

TEST_F(DracoTest, BrokenDataIsRefused) {
  TinyGltf file = makeFile();
  file.json["bufferViews"][0]["byteLength"] = file.binary.size() - 30;
  expectFailure(file, "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: its compressed data is broken");
  file = makeFile();
  json& extension = file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  extension["attributes"]["NORMAL"] = 9;
  expectFailure(file, "KHR_draco_mesh_compression.attributes.NORMAL: is not in the compressed data");
  extension["attributes"]["NORMAL"] = 1;
  extension["bufferView"] = 5;
  expectFailure(file, "KHR_draco_mesh_compression.bufferView: is 5");
  // Every byte of the compressed data bent: it loads or is refused in a line.
  const TinyGltf good = makeFile();
  for (size_t at = 0; at < good.binary.size(); ++at) {
    TinyGltf bad = good;
    bad.binary[at] = static_cast<char>(bad.binary[at] ^ (1 << at % 8));
    try {
      load(bad);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}
#endif

}  // namespace
}  // namespace radivox::tests
