// voxelize, faces and surface against exact geometry in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "modules/clustered_voxel/voxelize/grid.h"
#include "tests/clustered_voxel/voxel_run.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

using oracle::Soup;
using oracle::SoupTriangle;
using oracle::VoxelRun;
using oracle::VoxelStructures;

constexpr double kDilationBound = 4e-5;  // documented in voxelize.h

class VoxelizeTest : public oracles::GpuTest {
 protected:
  /// The ways to hold against compute.
  std::vector<std::string> otherMethods() {
    std::vector<std::string> all{"geometry"};
    if (device().capabilities().conservativeRasterization) all.emplace_back("hardware");
    return all;
  }
  VoxelStructures voxelize(const Soup& soup, uint32_t resolution, const std::string& method = "compute",
                           const VoxelRun::Settings& settings = {}) {
    return VoxelRun(device(), oracle::sceneOf(soup), resolution, method, settings).structures();
  }
};

SoupTriangle triangleOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& albedo = glm::vec3(0.5f)) {
  SoupTriangle triangle;
  triangle.position[0] = a;
  triangle.position[1] = b;
  triangle.position[2] = c;
  triangle.albedo = albedo;
  return triangle;
}

/// Triangles of every size in a box of 10 m, and two specks that pin its bounds.
Soup randomSoup(uint32_t seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.f, 10.f), unit(0.f, 1.f), sign(-1.f, 1.f);
  const auto point = [&] { return glm::vec3(place(random), place(random), place(random)); };
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const float size = std::pow(10.f, 3.f * unit(random) - 2.f);
    const auto near = [&](const glm::vec3& p) {
      return glm::clamp(p + size * glm::vec3(sign(random), sign(random), sign(random)), 0.f, 10.f);
    };
    const glm::vec3 a = point(), b = near(a);
    // Every third is a needle: its third corner lies next to its long edge.
    const glm::vec3 c = i % 3 == 0 ? a + 0.7f * (b - a) + 1e-4f * size * glm::vec3(sign(random), sign(random), sign(random)) : near(a);
    soup.push_back(triangleOf(a, b, glm::clamp(c, 0.f, 10.f), glm::vec3(unit(random), unit(random), unit(random))));
  }
  soup.push_back(triangleOf({0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}));
  soup.push_back(triangleOf({10, 10, 10}, {9.9f, 10, 10}, {10, 9.9f, 10}));
  return soup;
}

/// Exactly on voxel borders, duplicated, mirrored, and without area.
Soup borderSoup() {
  Soup soup;
  // N = 9 over 8 m: h = 1 m and borders at half metres.
  oracle::addQuad(soup, {0, 0, 0}, {8, 0, 0}, {0, 8, 0});
  oracle::addQuad(soup, {0, 0, 8}, {0, 8, 0}, {8, 0, 0});
  oracle::addQuad(soup, {0.5f, 0.5f, 2.5f}, {4, 0, 0}, {0, 4, 0});  // in the plane between two layers
  oracle::addQuad(soup, {0.5f, 0.5f, 2.5f}, {4, 0, 0}, {0, 4, 0});  // twice
  oracle::addQuad(soup, {0.5f, 0.5f, 2.5f}, {0, 4, 0}, {4, 0, 0});  // and from behind
  oracle::addQuad(soup, {0.5f, 0.5f, 0.5f}, {4, 4, 0}, {0, 0, 4});  // along a diagonal of the voxels
  soup.push_back(triangleOf({1.5f, 1.5f, 1.5f}, {5.5f, 5.5f, 5.5f}, {5.5f, 1.5f, 1.5f}));
  soup.push_back(triangleOf({1, 1, 7}, {7, 7, 1}, {4, 4, 4}));                             // a segment
  soup.push_back(triangleOf({3.5f, 6.5f, 6.5f}, {3.5f, 6.5f, 6.5f}, {3.5f, 6.5f, 6.5f}));  // a point on a corner of voxels
  return soup;
}

/// Every voxel that the exact test finds is there, and none that the exact test with dilated cubes does not find.
void expectConservative(const Soup& soup, const VoxelStructures& s) {
  VoxelStructures exact, dilated;
  exact.grid = dilated.grid = s.grid;
  oracle::fillOccupancy(exact, soup, 0.5);
  oracle::fillOccupancy(dilated, soup, 0.5 + kDilationBound);
  size_t missing = 0, surplus = 0, extra = 0;
  for (uint32_t brick = 0; brick < s.grid.brickCount; ++brick)
    for (int half = 0; half < 2; ++half) {
      const uint32_t got = s.occupancy[brick][half];
      missing += static_cast<size_t>(std::popcount(exact.occupancy[brick][half] & ~got));
      surplus += static_cast<size_t>(std::popcount(got & ~dilated.occupancy[brick][half]));
      extra += static_cast<size_t>(std::popcount(got & ~exact.occupancy[brick][half]));
    }
  EXPECT_EQ(missing, 0u);
  EXPECT_EQ(surplus, 0u);
  // Few triangles come that near to a voxel without touching it, unless they lie on borders.
  ::testing::Test::RecordProperty("voxels_by_dilation", static_cast<int>(extra));
}

/// Faces as the definition has them. A piece that hangs by a hair may be in one and not in the other.
void expectFaces(const VoxelStructures& expected, const VoxelStructures& got) {
  double expectedArea = 0, gotArea = 0;
  for (const shared::Face& face : expected.faces) expectedArea += face.area;
  for (const shared::Face& face : got.faces) gotArea += face.area;
  EXPECT_NEAR(gotArea, expectedArea, 1e-4 * expectedArea + 1e-6);
  size_t compared = 0, tooWide = 0;
  for (uint32_t i = 0; i < expected.faces.size(); ++i) {
    const shared::Face& want = expected.faces[i];
    if (want.area < 1e-3f) continue;
    const glm::uvec3 coordinate = expected.voxelCoordinate(want.key >> 3);
    const uint32_t voxel = got.voxelIndex(glm::ivec3(coordinate));
    ASSERT_NE(voxel, shared::kNone) << coordinate.x << ' ' << coordinate.y << ' ' << coordinate.z;
    const uint32_t face = got.faceIndex(voxel, want.key & 7);
    ASSERT_NE(face, shared::kNone) << coordinate.x << ' ' << coordinate.y << ' ' << coordinate.z << " face " << (want.key & 7);
    const shared::Face& have = got.faces[face];
    ++compared;
    EXPECT_EQ(have.key, voxel << 3 | (want.key & 7));
    EXPECT_NEAR(have.area, want.area, 2e-4 * want.area + 2e-5);
    const glm::vec3 n = shared::decodeNormal(have.normal), m = shared::decodeNormal(want.normal);
    EXPECT_GT(glm::dot(n, m), 0.9995f) << "normal of voxel " << coordinate.x << ' ' << coordinate.y << ' ' << coordinate.z;
    EXPECT_LT(glm::length(shared::decodePosition(have.position) - shared::decodePosition(want.position)), 0.02f);
    EXPECT_EQ(have.position & shared::kMadeOfBacks, want.position & shared::kMadeOfBacks);
    EXPECT_LT(glm::length(shared::decodeAlbedo(have.albedo) - shared::decodeAlbedo(want.albedo)), 0.01f);
    // The device's test of a piece against a slab may let one too many pass; a hair of surface may be lost.
    for (uint32_t end = 0; end < 16; end += 4) {
      const int free = static_cast<int>((shared::faceMargins(have) >> end) & 15u),
                wanted = static_cast<int>((shared::faceMargins(want) >> end) & 15u);
      EXPECT_LE(free, wanted + 1) << "margin at bit " << end << " of voxel " << coordinate.x << ' ' << coordinate.y << ' ' << coordinate.z;
      tooWide += free < wanted ? 1 : 0;
    }
    const glm::vec3 light = got.emission[face], wantedLight = expected.emission[i];
    EXPECT_LT(glm::length(light - wantedLight), 1e-3f * glm::length(wantedLight) + 1e-4f);
  }
  EXPECT_GT(compared, 0u);
  EXPECT_LT(static_cast<double>(tooWide), 0.15 * 4.0 * static_cast<double>(compared));
}

void expectSame(const VoxelStructures& a, const VoxelStructures& b) {
  ASSERT_EQ(std::memcmp(&a.grid, &b.grid, sizeof(a.grid)), 0);
  EXPECT_EQ(a.occupancy, b.occupancy);
  EXPECT_EQ(a.rank, b.rank);
  EXPECT_EQ(a.voxels, b.voxels);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.first, b.first);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  ASSERT_EQ(a.emission.size(), b.emission.size());
  // Nothing has no address.
  const auto sameBytes = [](const auto& x, const auto& y) {
    return x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  EXPECT_TRUE(sameBytes(a.faces, b.faces));
  EXPECT_TRUE(sameBytes(a.emission, b.emission));
}

TEST_F(VoxelizeTest, RandomTrianglesAreConservativeWithinTheBound) {
  for (const uint32_t resolution : {8u, 33u, 150u}) {
    SCOPED_TRACE(resolution);
    const Soup soup = randomSoup(resolution, resolution > 100 ? 60 : 200);
    expectConservative(soup, voxelize(soup, resolution));
  }
}

TEST_F(VoxelizeTest, SlowLongTrianglesThatTouchCornersAreNotLost) {
  // N = 1024 and h = 1 m: grid space is exact. The long edge passes exactly through a corner of voxels near its far end, so the cubes
  // beside it are just touched, and float products, which there round by more than the dilation, would lose some of them.
  constexpr float kUnit = 1.f / 16384.f;  // all coordinates are multiples: 24 bits
  std::mt19937 random(1024);
  std::uniform_int_distribution<int> component(10200, 11100), offset(0, 9), times(1400, 1450);
  Soup soup;
  soup.push_back(triangleOf({0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}));
  soup.push_back(triangleOf({1023, 1023, 4}, {1022.5f, 1023, 4}, {1023, 1022.5f, 4}));
  for (int i = 0; i < 60; ++i) {
    const bool falls = i % 2 == 1;
    const glm::vec2 step = kUnit * glm::vec2(component(random), falls ? -component(random) : component(random));
    const glm::vec2 through = glm::vec2(995 + offset(random), falls ? 15 + offset(random) : 995 + offset(random)) + 0.5f;
    const glm::vec2 a = through - static_cast<float>(times(random)) * step, b = through + 20.f * step;
    const glm::vec2 c = 0.5f * (a + b) + glm::vec2(-3.f, falls ? -3.f : 3.f);
    soup.push_back(triangleOf({a, 2}, {b, 2}, {c, 2}));
  }
  const VoxelStructures s = voxelize(soup, 1024);
  ASSERT_EQ(s.grid.h, 1.f);
  expectConservative(soup, s);
}

TEST_F(VoxelizeTest, TrianglesOnBordersAreConservative) {
  const VoxelStructures s = voxelize(borderSoup(), 9);
  ASSERT_FLOAT_EQ(s.grid.h, 1.f);
  ASSERT_EQ(s.grid.size, glm::uvec3(9));
  expectConservative(borderSoup(), s);
}

TEST_F(VoxelizeTest, SlowAllMethodsGiveTheSameBits) {
  const std::vector<std::pair<Soup, uint32_t>> cases{{borderSoup(), 9}, {randomSoup(77, 300), 40}, {randomSoup(78, 300), 256}};
  for (const auto& [soup, resolution] : cases) {
    SCOPED_TRACE(resolution);
    const VoxelStructures reference = voxelize(soup, resolution);
    for (const std::string& method : otherMethods()) {
      SCOPED_TRACE(method);
      expectSame(reference, voxelize(soup, resolution, method));
    }
  }
}

TEST_F(VoxelizeTest, HardwareMethodNamesWhatIsMissing) {
  if (device().capabilities().conservativeRasterization) GTEST_SKIP() << "this device has it";
  try {
    voxelize(randomSoup(1, 1), 8, "hardware");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
    EXPECT_NE(std::string(error.what()).find("VK_EXT_conservative_rasterization"), std::string::npos) << error.what();
  }
}

TEST_F(VoxelizeTest, SlowFacesFollowTheDefinition) {
  for (const uint32_t resolution : {9u, 24u, 70u}) {
    SCOPED_TRACE(resolution);
    Soup soup = randomSoup(11, 120);
    for (SoupTriangle& triangle : soup) triangle.emission = triangle.albedo * 3.f;
    expectFaces(oracle::buildVoxelStructures(soup, resolution), voxelize(soup, resolution));
  }
  SCOPED_TRACE("borders");
  expectFaces(oracle::buildVoxelStructures(borderSoup(), 9), voxelize(borderSoup(), 9));
}

TEST_F(VoxelizeTest, SurfaceBelongsToTheFaceThatItLooksAlongTheMost) {
  const VoxelRun::Settings dominant = {{"voxelize.faces", "dominant"}};
  for (const uint32_t resolution : {9u, 24u}) {
    SCOPED_TRACE(resolution);
    Soup soup = randomSoup(11, 120);
    for (SoupTriangle& triangle : soup) triangle.emission = triangle.albedo * 3.f;
    const VoxelStructures got = voxelize(soup, resolution, "compute", dominant),
                          expected = oracle::buildVoxelStructures(soup, resolution, true, true);
    expectFaces(expected, got);
    // All of the surface, once a side where it is double-sided: projections would add up to more.
    double area = 0, faces = 0;
    for (const double a : expected.voxelArea) area += 2 * a;
    for (const shared::Face& face : got.faces) faces += face.area;
    EXPECT_NEAR(faces, area, 1e-4 * area);
    EXPECT_LT(static_cast<double>(got.faces.size()), 0.8 * static_cast<double>(voxelize(soup, resolution).faces.size()));
    for (const std::string& method : otherMethods()) expectSame(got, voxelize(soup, resolution, method, dominant));
  }
  // At 45° to two axes the first gets it, however the normals were rounded.
  Soup slope;
  for (float x = 0.f; x < 5.f; x += 0.1f) oracle::addQuad(slope, {x, 0.3f * x, x}, {0.1f, 0.03f, 0.1f}, {-1.f, 0.f, 1.f});
  const VoxelStructures s = voxelize(slope, 30, "compute", dominant);
  for (const shared::Face& face : s.faces) EXPECT_EQ((face.key & 7u) >> 1, 1u);
  Soup diagonal;
  for (float x = 0.f; x < 5.f; x += 0.1f) oracle::addQuad(diagonal, {x, 0.f, x}, {0.1f, 0.f, 0.1f}, {0.f, 3.f, 0.f});
  for (const shared::Face& face : voxelize(diagonal, 30, "compute", dominant).faces) EXPECT_EQ((face.key & 7u) >> 1, 0u);
}

TEST_F(VoxelizeTest, SidesFollowTheMaterial) {
  Soup soup = randomSoup(21, 100);
  for (size_t i = 0; i < soup.size(); ++i) soup[i].doubleSided = i % 2 == 0;
  const VoxelStructures both = voxelize(soup, 20);
  const VoxelStructures gltf = voxelize(soup, 20, "compute", {{"voxelize.sides", "gltf"}});
  EXPECT_LT(gltf.faces.size(), both.faces.size());
  expectFaces(oracle::buildVoxelStructures(soup, 20, true), both);
  expectFaces(oracle::buildVoxelStructures(soup, 20, false), gltf);
  for (const std::string& method : otherMethods()) expectSame(gltf, voxelize(soup, 20, method, {{"voxelize.sides", "gltf"}}));
}

TEST_F(VoxelizeTest, TwoRunsGiveTheSameBits) {
  const Soup soup = randomSoup(3, 400);
  expectSame(voxelize(soup, 64), voxelize(soup, 64));
}

TEST_F(VoxelizeTest, ThinWallHasTwoSidesOfItsOwn) {
  // A sheet in the middle of a voxel layer: front red and lit from within, both sides of each voxel with the wall's whole area.
  Soup soup;
  oracle::addQuad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.8f, 0.2f, 0.1f}, {5, 4, 3});
  const VoxelStructures s = voxelize(soup, 16);
  double front = 0, back = 0;
  for (uint32_t i = 0; i < s.faces.size(); ++i) {
    const shared::Face& face = s.faces[i];
    ASSERT_EQ((face.key & 7) >> 1, 2u) << "only ±z";
    const bool isFront = (face.key & 7) == 4;
    (isFront ? front : back) += face.area;
    EXPECT_NEAR(shared::decodeNormal(face.normal).z, isFront ? 1.f : -1.f, 1e-6f);
    const glm::vec3 light = isFront ? glm::vec3(5, 4, 3) * std::numbers::pi_v<float> : glm::vec3(0.f);
    EXPECT_LT(glm::length(s.emission[i] - light), 1e-4f);
    EXPECT_LT(glm::length(shared::decodeAlbedo(face.albedo) - glm::vec3(0.8f, 0.2f, 0.1f)), 1e-4f);
  }
  const double h2 = double{s.grid.h} * s.grid.h;
  EXPECT_NEAR(front * h2, 1.0, 1e-5);
  EXPECT_NEAR(back * h2, 1.0, 1e-5);
}

TEST_F(VoxelizeTest, SlowAreaOfVoxelsIsAreaOfTheMesh) {
  const std::vector<std::pair<std::string, uint32_t>> cases{{"cornell", 8}, {"cornell", 61}, {"cornell", 256},
                                                            {"sphere", 8},  {"sphere", 256}, {"thin_wall", 61}};
  for (const auto& [name, resolution] : cases) {
    SCOPED_TRACE(name + " " + std::to_string(resolution));
    const scene::Scene scene = scene::loadScene("builtin:" + name);
    VoxelRun run(device(), scene, resolution);
    run.structures();
    EXPECT_NEAR(run.figure("surface", "total_area") / scene.traits().surfaceArea, 1.0, 1e-4);
  }
}

TEST_F(VoxelizeTest, FaceNormalsOfASphereAreRadial) {
  const scene::Scene scene = scene::loadScene("builtin:sphere");
  const scene::Traits traits = scene.traits();
  const VoxelStructures s = VoxelRun(device(), scene, 40).structures();
  const glm::vec3 middle = 0.5f * (traits.boundsMin + traits.boundsMax);
  size_t outward = 0;
  for (uint32_t i = 0; i < s.faces.size(); ++i) {
    const glm::vec3 radial = glm::normalize(s.grid.origin + s.grid.h * s.facePosition(i) - middle);
    const glm::vec3 n = shared::decodeNormal(s.faces[i].normal);
    const glm::vec3 e = shared::faceVector(s.faces[i].key & 7);
    EXPECT_GE(glm::dot(n, e), -0.2f);
    outward += std::abs(glm::dot(n, radial)) > 0.98f ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(outward), 0.97 * static_cast<double>(s.faces.size()));
}

TEST_F(VoxelizeTest, HeuristicNormalIsTheFreestAxis) {
  // A floor: all that is free lies above and below; the surface looks up, so up it is, and down for the lower side.
  Soup soup;
  oracle::addQuad(soup, {0, 0, 0}, {0, 0.2f, 1}, {1, 0, 0});
  const VoxelRun::Settings heuristic{{"surface.normals", "heuristic"}};
  const VoxelStructures s = voxelize(soup, 24, "compute", heuristic);
  size_t vertical = 0, faces = 0;
  for (uint32_t i = 0; i < s.faces.size(); ++i) {
    const glm::vec3 n = shared::decodeNormal(s.faces[i].normal);
    ASSERT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.f, 1e-6f) << "an axis";
    const glm::ivec3 at(s.voxelCoordinate(s.faces[i].key >> 3));
    // Away from the rim, where other axes have more free neighbours.
    if (at.x < 1 || at.z < 1 || at.x + 2 > static_cast<int>(s.grid.size.x) || at.z + 2 > static_cast<int>(s.grid.size.z)) continue;
    ++faces;
    vertical += std::abs(n.y) > 0.5f ? 1 : 0;
    const glm::vec3 mean = glm::normalize(glm::vec3(0, 1, -0.2f));
    const bool up = (s.faces[i].key & 7) == 2 || (s.faces[i].key & 7) == 5;
    EXPECT_GT(glm::dot(n, up ? mean : -mean), 0.f) << "on the face's side";
  }
  EXPECT_EQ(vertical, faces);
  EXPECT_GT(faces, 100u);
  for (const std::string& method : otherMethods()) expectSame(s, voxelize(soup, 24, method, heuristic));
}

TEST_F(VoxelizeTest, EmptySceneHasNothing) {
  const VoxelStructures s = voxelize({}, 32);
  EXPECT_EQ(s.grid.size, glm::uvec3(1));
  EXPECT_TRUE(s.voxels.empty());
  EXPECT_TRUE(s.faces.empty());
  EXPECT_EQ(s.first, std::vector<uint32_t>{0});
  EXPECT_EQ(s.brickDistance(0), 255u);
}

TEST_F(VoxelizeTest, OneTriangleOnePoint) {
  const Soup one{triangleOf({0, 0, 0}, {1, 0.3f, 0.2f}, {0.1f, 0.8f, 0.6f})};
  expectConservative(one, voxelize(one, 31));
  const Soup point{triangleOf({3, 4, 5}, {3, 4, 5}, {3, 4, 5})};
  const VoxelStructures s = voxelize(point, 64);
  EXPECT_EQ(s.voxels.size(), 1u);
  EXPECT_TRUE(s.faces.empty());
  for (const std::string& method : otherMethods()) expectSame(s, voxelize(point, 64, method));
}

TEST_F(VoxelizeTest, TooFineAGridSaysWhatFits) {
  scene::Traits traits;
  traits.boundsMax = glm::vec3(1.f);
  try {
    clustered_voxel::makeGridWithin(traits, 1024, uint64_t{1} << 20, "voxelize.resolution");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::OutOfMemory);
    EXPECT_NE(std::string(error.what()).find("voxelize.resolution=200 or less"), std::string::npos) << error.what();
  }
  EXPECT_EQ(clustered_voxel::makeGridWithin(traits, 200, uint64_t{1} << 20, "voxelize.resolution").size, glm::uvec3(200));
}

TEST_F(VoxelizeTest, AlphaMaskTakesItsShareOfArea) {
  // The left half of the texture is a hole: left half of the quad has voxels, but no faces.
  Soup soup;
  oracle::addQuad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  scene::Scene scene = oracle::sceneOf(soup);
  scene::TextureImage image;
  image.name = "mask";
  image.width = image.height = 64;
  image.nearest = true;
  for (uint32_t i = 0; i < 64 * 64; ++i)
    for (const uint8_t value : {uint8_t{255}, uint8_t{128}, uint8_t{0}, static_cast<uint8_t>(i % 64 < 32 ? 0 : 255)})
      image.rgba.push_back(value);
  scene.textures.push_back(image);
  for (shared::Vertex& vertex : scene.vertices) vertex.uvBase = glm::vec2(vertex.position);
  for (shared::Material& material : scene.materials) {
    material.albedo = glm::vec3(1.f);
    material.baseTexture = 0;
    material.alphaCutoff = 0.5f;
    material.flags |= shared::kMaterialAlphaMask;
  }
  const VoxelStructures reference = VoxelRun(device(), scene, 33).structures();
  double area = 0;
  for (uint32_t i = 0; i < reference.faces.size(); ++i) {
    const shared::Face& face = reference.faces[i];
    EXPECT_GT(reference.grid.origin.x + reference.grid.h * reference.facePosition(i).x, 0.499f);
    area += 0.5 * face.area * reference.grid.h * reference.grid.h;
    const glm::vec3 albedo = shared::decodeAlbedo(face.albedo);
    EXPECT_NEAR(albedo.x, 0.999f, 1e-4f) << "as bright as surfaces may be";
    EXPECT_NEAR(albedo.y, 0.2158f, 1e-3f) << "sRGB 128, linear";
  }
  EXPECT_NEAR(area, 0.5, 0.01);
  EXPECT_EQ(reference.voxels.size(), 33u * 33u) << "occupancy stays conservative";
  for (const std::string& method : otherMethods()) expectSame(reference, VoxelRun(device(), scene, 33, method).structures());
}

TEST_F(VoxelizeTest, SlowSponzaKeepsItsAreaAndTheBound) {
  const std::string shared = oracles::sharedFolder();
  if (shared.empty()) GTEST_SKIP() << "no shared scenes";
  const scene::Scene scene = scene::loadScene(shared + "/scenes/sponza.glb");
  const Soup soup = oracle::soupOf(scene);
  VoxelRun run(device(), scene, 64);
  const VoxelStructures s = run.structures();
  EXPECT_NEAR(run.figure("surface", "total_area") / scene.traits().surfaceArea, 1.0, 1e-4);
  expectConservative(soup, s);
  for (const std::string& method : otherMethods()) {
    SCOPED_TRACE(method);
    expectSame(s, VoxelRun(device(), scene, 64, method).structures());
  }
}

}  // namespace
}  // namespace radivox
