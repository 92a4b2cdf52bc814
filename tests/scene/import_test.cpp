// glTF import: what each feature must become.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/gltf.h"
#include "engine/scene/sky.h"
#include "tests/scene/tiny_gltf.h"

namespace radivox::tests {
namespace {

using nlohmann::json;
using scene::Scene;

class ImportTest : public ::testing::Test {
 protected:
  Scene load(const TinyGltf& file) { return scene::importGltf(folder_.write("scene.gltf", file.gltf())); }
  static glm::vec3 corner(const Scene& s, size_t triangle, size_t k) { return s.vertices[s.indices[triangle * 3 + k]].position; }
  static glm::vec3 geometricNormal(const Scene& s, size_t t) {
    return glm::normalize(glm::cross(corner(s, t, 1) - corner(s, t, 0), corner(s, t, 2) - corner(s, t, 0)));
  }
  static bool hasWarning(const Scene& s, const std::string& part) {
    for (const auto& w : s.warnings) {
      if (w.find(part) != std::string::npos) return true;
    }
    return false;
  }
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

TEST_F(ImportTest, SameSceneFromGlbDataUriAndExternalBuffer) {
  TinyGltf file;
  file.addTriangle();
  folder_.write("a b.bin", file.binary);
  const Scene scenes[3] = {scene::importGltf(folder_.write("a.glb", file.glb())), scene::importGltf(folder_.write("b.gltf", file.gltf())),
                           scene::importGltf(folder_.write("c.gltf", file.gltf("a%20b.bin")))};
  for (const Scene& s : scenes) {
    ASSERT_EQ(s.triangleCount(), 1u);
    EXPECT_EQ(corner(s, 0, 1), glm::vec3(1, 0, 0));
    expectNear(s.vertices[0].normal, {0, 0, 1});  // missing normals are flat
    ASSERT_EQ(s.materials.size(), 1u);
    EXPECT_EQ(s.materials[0].albedo, glm::vec3(0.999f));
    ASSERT_EQ(s.cameras.size(), 1u);
    EXPECT_EQ(s.origin, glm::dvec3(0.0));
  }
}

TEST_F(ImportTest, HierarchyWithMatrixAndTrsInstances) {
  TinyGltf file;
  file.addTriangle();
  const double half = std::sqrt(0.5);
  file.json["nodes"] = json::array({{{"translation", {10, 0, 0}}, {"children", {1, 2}}},
                                    {{"rotation", {0, 0, half, half}}, {"scale", {2, 3, 1}}, {"mesh", 0}},  // 90° about z
                                    {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}, {"mesh", 0}}});
  file.json["scenes"][0]["nodes"] = {0};
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 2u);
  expectNear(corner(s, 0, 0), {10, 0, 0});
  expectNear(corner(s, 0, 1), {10, 2, 0});
  expectNear(corner(s, 0, 2), {7, 0, 0});
  expectNear(corner(s, 1, 0), {10, 5, 0});
  expectNear(corner(s, 1, 1), {11, 5, 0});
}

TEST_F(ImportTest, MirrorsKeepFrontsAndNormalsTogether) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const size_t normals = file.addVec3({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const size_t with = file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
  const size_t without = file.addMesh({{"attributes", {{"POSITION", positions}}}});
  for (const json& scale : {json{-1, 1, 1}, json{1, 1, -1}, json{-2, -3, -0.5}, json{-1, -1, 1}}) {
    file.addNode({{"mesh", with}, {"scale", scale}});
    file.addNode({{"mesh", without}, {"scale", scale}});
  }
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 8u);
  const float facing[4] = {1, -1, -1, 1};  // a mirrored front stays the front: the sign of the z scale
  for (size_t t = 0; t < 8; ++t) {
    expectNear(geometricNormal(s, t), {0, 0, facing[t / 2]});
    for (size_t k = 0; k < 3; ++k) expectNear(s.vertices[s.indices[t * 3 + k]].normal, {0, 0, facing[t / 2]});
  }
}

TEST_F(ImportTest, NormalsUseTheInverseTranspose) {
  TinyGltf file;
  const glm::vec3 n = glm::normalize(glm::vec3(1, 1, 0));  // of a plane through these corners
  const size_t positions = file.addVec3({{1, 0, 0}, {0, 1, 0}, {0, 1, 1}});
  const size_t normals = file.addVec3({n, n, n * 3.f});  // of any length
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})}, {"scale", {4, 1, 1}}});
  const Scene s = load(file);
  for (const auto& vertex : s.vertices) expectNear(vertex.normal, glm::normalize(glm::vec3(0.25f, 1, 0)));
}

TEST_F(ImportTest, PrimitiveModes) {
  TinyGltf file;
  const size_t square = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});  // strip order
  const size_t fan = file.addVec3({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const size_t stitched = file.addIndices({0, 1, 2, 3, 3, 0, 0, 1, 2, 3});  // two strips with a seam
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", square}}}, {"mode", 5}})}});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", fan}}}, {"mode", 6}})}});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", square}}}, {"mode", 5}, {"indices", stitched}})}});
  for (const int mode : {0, 1, 2, 3}) file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", square}}}, {"mode", mode}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 2u + 2u + 4u);
  for (size_t t = 0; t < s.triangleCount(); ++t) expectNear(geometricNormal(s, t), {0, 0, 1});
  EXPECT_NEAR(s.traits().surfaceArea, 4.0, 1e-6);
  EXPECT_TRUE(hasWarning(s, "4 × points and lines are left out")) << allWarnings(s);
  EXPECT_FALSE(hasWarning(s, "without area")) << allWarnings(s);  // seams of strips are no news
}

TEST_F(ImportTest, IndexTypes) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const size_t bytes = file.addAccessor(std::vector<uint8_t>{0, 1, 2}, 5121, "SCALAR", 3);
  const size_t shorts = file.addAccessor(std::vector<uint16_t>{0, 2, 3}, 5123, "SCALAR", 3);
  const size_t words = file.addIndices({1, 2, 3});
  for (const size_t indices : {bytes, shorts, words})
    file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 3u);
  EXPECT_EQ(corner(s, 0, 2), glm::vec3(1, 1, 0));
  EXPECT_EQ(corner(s, 1, 2), glm::vec3(0, 1, 0));
  EXPECT_EQ(corner(s, 2, 0), glm::vec3(1, 0, 0));
}

TEST_F(ImportTest, QuantizedAndStridedAttributes) {
  TinyGltf file;
  file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  // Positions: normalized shorts, 8 bytes apart; normals: normalized bytes, 4 apart; plain unsigned bytes for a second mesh.
  const size_t positions = file.addAccessor(std::vector<int16_t>{0, 0, 0, 99, 32767, 0, 0, 99, 0, -32768, 0, 99}, 5122, "VEC3", 3, 8);
  file.json["accessors"][positions]["normalized"] = true;
  const size_t normals = file.addAccessor(std::vector<int8_t>{0, 0, -127, 9, 0, 0, -127, 9, 0, 0, -127, 9}, 5120, "VEC3", 3, 4);
  file.json["accessors"][normals]["normalized"] = true;
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})}});
  const size_t plain = file.addAccessor(std::vector<uint8_t>{0, 0, 0, 0, 200, 0, 0, 0, 0, 255, 0, 0}, 5121, "VEC3", 3, 4);
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", plain}}}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 2u);
  EXPECT_EQ(corner(s, 0, 1), glm::vec3(1, 0, 0));
  EXPECT_EQ(corner(s, 0, 2), glm::vec3(0, -1, 0));  // −32768 is −1 too
  expectNear(s.vertices[s.indices[0]].normal, {0, 0, -1});
  EXPECT_EQ(corner(s, 1, 1), glm::vec3(200, 0, 0));
  EXPECT_EQ(corner(s, 1, 2), glm::vec3(0, 255, 0));
}

TEST_F(ImportTest, SparseAccessors) {
  TinyGltf file;
  const size_t dense = file.addVec3({{0, 0, 0}, {9, 9, 9}, {0, 1, 0}});
  const size_t view = file.addView(std::vector<uint16_t>{1}.data(), 2);
  const glm::vec3 value(1, 0, 0);
  const size_t values = file.addView(&value, 12);
  const json sparse = {{"count", 1}, {"indices", {{"bufferView", view}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
  file.json["accessors"][dense]["sparse"] = sparse;
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", dense}}}})}});
  // Without a buffer view everything else is zero.
  file.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 3}, {"sparse", sparse}});
  const size_t zeros = file.json["accessors"].size() - 1;
  const size_t order = file.addIndices({0, 1, 2});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", zeros}}}, {"indices", order}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 1u);  // the second has no area
  EXPECT_EQ(corner(s, 0, 1), glm::vec3(1, 0, 0));
  EXPECT_TRUE(hasWarning(s, "1 triangles without area"));
}

TEST_F(ImportTest, MaterialsAsDiffuseSurfaces) {
  TinyGltf file;
  file.json["materials"] =
      json::array({{{"name", "bright"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1.5, 0.5, -0.25, 0.7}}}}, {"doubleSided", true}},
                   {{"emissiveFactor", {1, 0.5, 0.25}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 17}}}}}},
                   {{"alphaMode", "MASK"}},
                   {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}},
                   {{"alphaMode", "BLEND"}},
                   {{"extensions", {{"KHR_materials_unlit", json::object()}}}},
                   {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 1}}}}}}}});
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (size_t m = 0; m < 7; ++m) file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}}}, {"material", m}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.materials.size(), 7u);
  EXPECT_EQ(s.materialNames[0], "bright");
  EXPECT_EQ(s.materials[0].albedo, glm::vec3(0.999f, 0.5f, 0.f));
  EXPECT_FLOAT_EQ(s.materials[0].alpha, 0.7f);
  EXPECT_EQ(s.materials[0].flags, shared::kMaterialDoubleSided);
  EXPECT_EQ(s.materials[1].emission, glm::vec3(17.f, 8.5f, 4.25f));
  EXPECT_EQ(s.materials[1].flags, shared::kMaterialEmissive);
  EXPECT_EQ(s.materials[2].flags, shared::kMaterialAlphaMask);
  EXPECT_FLOAT_EQ(s.materials[2].alphaCutoff, 0.5f);
  EXPECT_FLOAT_EQ(s.materials[3].alphaCutoff, 0.25f);
  EXPECT_EQ(s.materials[4].flags, 0u);
  EXPECT_EQ(s.materials[6].albedo, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_TRUE(hasWarning(s, "alpha-blended"));
  EXPECT_TRUE(hasWarning(s, "unlit"));
  EXPECT_TRUE(hasWarning(s, "specular-glossiness"));
  const auto traits = s.traits();
  EXPECT_EQ(traits.emissiveTriangleCount, 1u);
  EXPECT_TRUE(traits.alphaMasked);
  EXPECT_TRUE(traits.singleSided);
  EXPECT_TRUE(traits.emittersByRays);  // a seventh of the surface
}

TEST_F(ImportTest, PrimitivesWithoutMaterialGetTheDefaultLast) {
  TinyGltf file;
  file.json["materials"] = json::array({{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}}});
  file.addTriangle();
  const Scene s = load(file);
  ASSERT_EQ(s.materials.size(), 2u);
  EXPECT_EQ(s.triangleMaterials[0], 1u);
  EXPECT_EQ(s.materials[1].albedo, glm::vec3(0.999f));
}

TEST_F(ImportTest, LightsInRadiometricUnits) {
  TinyGltf file;
  file.addTriangle();
  file.json["extensionsUsed"] = {"KHR_lights_punctual"};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] =
      json::array({{{"type", "directional"}, {"color", {1, 0.5, 0.25}}, {"intensity", 10}, {"name", "sun"}},
                   {{"type", "point"}, {"intensity", 3}, {"range", 7}},
                   {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
                   {{"type", "point"}, {"intensity", 0}},
                   {{"type", "spot"}}});
  const auto reference = [](int i) { return json{{"KHR_lights_punctual", {{"light", i}}}}; };
  const double half = std::sqrt(0.5);
  // Scales must not change intensity or direction; −90° about x turns −z to −y.
  file.addNode({{"extensions", reference(0)}, {"rotation", {-half, 0, 0, half}}, {"scale", {2, 3, 4}}});
  file.addNode({{"extensions", reference(1)}, {"translation", {1, 2, 3}}, {"scale", {10, 10, 10}}});
  file.addNode({{"extensions", reference(2)}});
  file.addNode({{"extensions", reference(3)}});
  file.addNode({{"extensions", reference(4)}});
  const Scene s = load(file);
  ASSERT_EQ(s.lights.size(), 4u);
  EXPECT_EQ(s.lights[0].type, shared::kLightDirectional);
  EXPECT_EQ(s.lights[0].name, "sun");
  EXPECT_EQ(s.lights[0].intensity, glm::vec3(10, 5, 2.5));
  expectNear(s.lights[0].direction, {0, -1, 0});
  EXPECT_EQ(s.lights[1].intensity, glm::vec3(3));
  EXPECT_EQ(s.lights[1].range, 7.f);
  expectNear(s.lights[1].position, {1, 2, 3});
  EXPECT_FLOAT_EQ(s.lights[2].innerConeAngle, 0.2f);
  EXPECT_FLOAT_EQ(s.lights[2].outerConeAngle, 0.6f);
  EXPECT_EQ(s.lights[2].intensity, glm::vec3(1));
  EXPECT_FLOAT_EQ(s.lights[3].outerConeAngle, glm::quarter_pi<float>());
  EXPECT_TRUE(hasWarning(s, "intensity 0"));
  const auto traits = s.traits();
  EXPECT_EQ(traits.directionalLightCount, 1u);
  EXPECT_EQ(traits.pointLightCount, 1u);
  EXPECT_EQ(traits.spotLightCount, 2u);
}

TEST_F(ImportTest, Cameras) {
  TinyGltf file;
  file.addTriangle();
  file.json["cameras"] = json::array(
      {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 1e-5}, {"aspectRatio", 3}}}},
       {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1.5}, {"znear", 5}, {"zfar", 6}}}, {"name", "flat"}}});
  const double half = std::sqrt(0.5);
  file.addNode({{"camera", 0}, {"name", "eye"}, {"translation", {0, 0, 5}}, {"scale", {3, 3, 3}}});
  file.addNode({{"camera", 1}, {"rotation", {0, half, 0, half}}});  // 90° about y: looks along −x
  const Scene s = load(file);
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_EQ(s.cameras[0].name, "eye");
  EXPECT_FLOAT_EQ(s.cameras[0].yfov, 0.9f);
  EXPECT_FLOAT_EQ(s.cameras[0].znear, 1e-5f);
  expectNear(scene::makeCamera(s.cameras[0], 8, 8).forward, {0, 0, -1});
  EXPECT_EQ(s.cameras[1].name, "flat");
  EXPECT_TRUE(s.cameras[1].orthographic);
  EXPECT_FLOAT_EQ(s.cameras[1].ymag, 1.5f);
  EXPECT_LE(s.cameras[1].znear, 0.01f);  // a near plane that would cut the scene is moved
  EXPECT_GE(s.cameras[1].zfar, 1.4f);
  expectNear(scene::makeCamera(s.cameras[1], 8, 8).forward, {-1, 0, 0});
}

TEST_F(ImportTest, DefaultSceneElseTheOnlyElseAllRoots) {
  TinyGltf file;
  file.addTriangle();
  file.json["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 0}, {"children", {2}}}, {{"mesh", 0}}});
  file.json["scenes"] = json::array({{{"nodes", {0}}}, {{"nodes", {1}}}});
  file.json["scene"] = 1;
  EXPECT_EQ(load(file).triangleCount(), 2u);
  file.json.erase("scene");
  EXPECT_EQ(load(file).triangleCount(), 3u);
  file.json["scenes"] = json::array({{{"nodes", {0}}}});
  EXPECT_EQ(load(file).triangleCount(), 1u);
  file.json.erase("scenes");
  EXPECT_EQ(load(file).triangleCount(), 3u);
}

TEST_F(ImportTest, FarScenesKeepTheirPrecision) {
  TinyGltf file;
  file.addTriangle();
  file.json["nodes"][0]["translation"] = {1e6 + 0.25, -3e6, 2e6};
  file.json["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.001}}}}});
  file.addNode({{"camera", 0}, {"translation", {1e6 + 0.5, -3e6, 2e6 + 3}}});
  const Scene s = load(file);
  EXPECT_NE(s.origin, glm::dvec3(0.0));
  for (glm::length_t i = 0; i < 3; ++i) EXPECT_EQ(s.origin[i], std::floor(s.origin[i]));
  const glm::dvec3 world = s.origin + glm::dvec3(corner(s, 0, 0));
  EXPECT_EQ(world, glm::dvec3(1e6 + 0.25, -3e6, 2e6));
  EXPECT_EQ(s.origin + glm::dvec3(s.cameras[0].position), glm::dvec3(1e6 + 0.5, -3e6, 2e6 + 3));
  EXPECT_EQ(corner(s, 0, 1) - corner(s, 0, 0), glm::vec3(1, 0, 0));
}

TEST_F(ImportTest, NearScenesStayWhereTheyAre) {
  TinyGltf file;
  file.addTriangle();
  file.json["nodes"][0]["translation"] = {900, 0, 0};
  const Scene s = load(file);
  EXPECT_EQ(s.origin, glm::dvec3(0.0));
  EXPECT_EQ(corner(s, 0, 1), glm::vec3(901, 0, 0));
}

TEST_F(ImportTest, UnusableNormalsBecomeGeometric) {
  const float nan = std::nanf("");
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  const size_t normals = file.addVec3({{0, 0, 0}, {nan, 0, 1}, {0.6f, 0, 0.8f}, {0, INFINITY, 0}});
  const size_t indices = file.addIndices({0, 1, 2, 1, 3, 2});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}})}});
  const Scene s = load(file);
  ASSERT_EQ(s.vertices.size(), 4u);
  expectNear(s.vertices[0].normal, {0, 0, 1});
  expectNear(s.vertices[1].normal, {0, 0, 1});
  expectNear(s.vertices[2].normal, {0.6f, 0, 0.8f});
  expectNear(s.vertices[3].normal, {0, 0, 1});
  EXPECT_TRUE(hasWarning(s, "3 × normals that are zero or not finite")) << allWarnings(s);
}

TEST_F(ImportTest, TrianglesWithoutAreaAreCountedAndLeftOut) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {3, 0, 0}});
  const size_t indices = file.addIndices({0, 1, 2, 0, 0, 1, 0, 1, 3, 1, 3, 4});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  file.addNode({{"mesh", 0}, {"scale", {1, 0, 1}}});  // flattened to a line
  const Scene s = load(file);
  EXPECT_EQ(s.triangleCount(), 1u);
  EXPECT_EQ(s.triangleMaterials.size(), 1u);
  EXPECT_EQ(s.vertices.size(), 3u);
  EXPECT_TRUE(hasWarning(s, "7 triangles without area")) << allWarnings(s);
}

TEST_F(ImportTest, EmptyAndUnlitScenes) {
  const Scene nothing = load(TinyGltf());
  EXPECT_EQ(nothing.triangleCount(), 0u);
  ASSERT_EQ(nothing.cameras.size(), 1u);
  EXPECT_GE(nothing.materials.size(), 1u);
  EXPECT_TRUE(hasWarning(nothing, "no triangles"));
  EXPECT_FALSE(nothing.traits().lit());
  TinyGltf dark;
  dark.addTriangle();
  EXPECT_TRUE(hasWarning(load(dark), "no light"));
  dark.json["scenes"][0]["extras"]["radivox"]["skyRadiance"] = {0.1, 0.2, 0.3};
  const Scene sky = load(dark);
  EXPECT_EQ(sky.skyRadiance, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_TRUE(sky.traits().sky);
  EXPECT_FALSE(hasWarning(sky, "no light"));
}

TEST_F(ImportTest, TheImageOfASkyLiesBesideTheFile) {
  TinyGltf file;
  file.addTriangle();
  file.json["scenes"][0]["extras"]["radivox"]["sky"] = {{"uri", "builtin:clear"}, {"turn", 90}, {"scale", 2}, {"sun", "keep"}};
  const Scene clear = load(file);
  ASSERT_NE(clear.sky, nullptr);
  EXPECT_TRUE(clear.traits().skyImage);
  EXPECT_EQ(clear.traits().directionalLightCount, 0u) << "the sun was kept";
  EXPECT_NEAR(clear.sky->turn, 1.5708, 1e-4);
  EXPECT_FALSE(hasWarning(clear, "no light"));
  file.json["scenes"][0]["extras"]["radivox"]["sky"] = {{"uri", "builtin:clear"}};
  const Scene sunny = load(file);
  EXPECT_EQ(sunny.traits().directionalLightCount, 1u);
  EXPECT_TRUE(hasWarning(sunny, "became a directional light")) << allWarnings(sunny);
  EXPECT_EQ(clear.sky->texels[0], 2.f * sunny.sky->texels[0]);
}

TEST_F(ImportTest, WhatIsLeftOutIsSaid) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const size_t white = file.addVec3({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", white}}}})}});
  EXPECT_FALSE(hasWarning(load(file), "vertex colours"));
  const size_t red = file.addVec3({{1, 0, 0}, {1, 1, 1}, {1, 1, 1}});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", red}}}})}});
  file.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing", "KHR_materials_transmission"};
  file.json["animations"] = json::array({{{"channels", json::array()}, {"samplers", json::array()}}});
  const Scene s = load(file);
  EXPECT_TRUE(hasWarning(s, "vertex colours"));
  EXPECT_TRUE(hasWarning(s, "EXT_mesh_gpu_instancing"));
  EXPECT_TRUE(hasWarning(s, "KHR_materials_transmission"));
  EXPECT_TRUE(hasWarning(s, "animations"));
}

TEST_F(ImportTest, SlowDeepHierarchiesNeedNoStack) {
  TinyGltf file;
  file.addTriangle();
  constexpr size_t kDepth = 200000;
  json nodes = json::array();
  for (size_t i = 0; i < kDepth; ++i) nodes.push_back({{"translation", {0, 0, 0.001}}, {"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}});
  file.json["nodes"] = nodes;
  const Scene s = load(file);
  ASSERT_EQ(s.triangleCount(), 1u);
  EXPECT_NEAR(corner(s, 0, 0).z, 200.f, 1e-4f);
}

}  // namespace
}  // namespace radivox::tests
