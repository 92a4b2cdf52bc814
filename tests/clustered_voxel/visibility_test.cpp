// clustered_voxel.visibility: rows against the CPU traversal, bit for bit, and what it promises of them.
#include "modules/clustered_voxel/visibility/visibility.h"

#include <gtest/gtest.h>

#include "shaders/shared/voxel.h"
#include "tests/clustered_voxel/visibility_run.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox {
namespace {

using oracle::buildVoxelStructures;
using oracle::checkRows;
using oracle::Row;
using oracle::runLabels;
using oracle::VisibilityRun;
using oracle::VisibilitySettings;
using oracle::VoxelStructures;

class VisibilityTest : public oracles::GpuTest {};

TEST_F(VisibilityTest, RowsEqualTheCpuTraversal) {
  for (const uint32_t n : {16u, 32u}) checkRows(device(), buildVoxelStructures(oracle::roomSoup(), n), {.rays = 32});
}

TEST_F(VisibilityTest, RowsOfDominantFacesEqualTheCpuTraversal) {
  checkRows(device(), buildVoxelStructures(oracle::roomSoup(), 20, true, true), {.rays = 32});
  for (uint32_t seed = 1; seed <= 2; ++seed)
    checkRows(device(), buildVoxelStructures(oracle::randomSoup(seed, 24), 17, seed == 1, true), {.rays = 32, .near = 4.f});
}

TEST_F(VisibilityTest, SlowRandomSoupsAndOneSidedSurfaces) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const bool bothSides = seed % 2 == 0;
    const VoxelStructures s = buildVoxelStructures(oracle::randomSoup(seed, 24), 12 + 5 * seed, bothSides);
    const std::vector<Row> rows = checkRows(device(), s, {.rays = 48, .near = 4.f});
    uint32_t absorbed = 0;
    for (const Row& row : rows) absorbed += row.count(shared::kAbsorbed) != 0 ? 1 : 0;
    EXPECT_EQ(absorbed > 0, !bothSides);
  }
}

TEST_F(VisibilityTest, SlowEveryVariantEqualsItsDefinition) {
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 20);
  for (const bool axis : {false, true}) {
    for (const bool voxel : {false, true}) checkRows(device(), s, {.rays = 24, .axisFrame = axis, .voxelHit = voxel});
    checkRows(device(), s, {.rays = 24, .bresenham = true, .axisFrame = axis, .near = 3.f});
  }
  const VoxelStructures oneSided = buildVoxelStructures(oracle::randomSoup(7, 20), 16, false);
  checkRows(device(), oneSided, {.rays = 16, .bresenham = true, .axisFrame = true});
  checkRows(device(), oneSided, {.rays = 16, .voxelHit = true});
}

// Under the image of a sky misses keep more of where they went.
TEST_F(VisibilityTest, FinerBinsOfDirectionsEqualTheirDefinition) {
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 16);
  checkRows(device(), s, {.rays = 64, .skyImage = true});
  checkRows(device(), s, {.rays = 24, .bresenham = true, .axisFrame = true, .skyImage = true});
  uint32_t bins = 0;
  for (const Row& row : checkRows(device(), buildVoxelStructures(oracle::randomSoup(3, 24), 16, false), {.rays = 48, .skyImage = true})) {
    for (const auto& [id, count] : row) bins |= id >= shared::kMissBase + 6 && id < shared::kAbsorbed ? 1u : 0u;
  }
  EXPECT_EQ(bins, 1u);
}

TEST_F(VisibilityTest, SlowAnyNumberOfRays) {
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 12);
  for (const uint32_t rays : {1u, 2u, 3u, 31u, 33u, 100u, 255u, 256u}) checkRows(device(), s, {.rays = rays});
}

TEST_F(VisibilityTest, SlowNearHitsKeepTheirFace) {
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 16);
  for (const float near : {0.f, 1.f, 6.f, 4096.f}) {
    const std::vector<Row> rows = checkRows(device(), s, {.rays = 32, .near = near});
    const uint32_t clusters = runLabels(s.faces.size(), 7).back() + 1;
    uint32_t faces = 0, far = 0;
    for (const Row& row : rows) {
      for (const auto& [id, n] : row) (id < clusters ? far : faces) += id < shared::kMissBase ? n : 0;
    }
    EXPECT_EQ(far == 0, near == 4096.f);
    EXPECT_GT(faces, 0u);  // a start on another voxel's border hits at distance 0
  }
}

TEST_F(VisibilityTest, SlowManyChunksAndEveryWayOverEmptySpace) {
  // More than two chunks of faces: rows are found again in theirs, and leaping changes nothing.
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 64);
  ASSERT_GT(s.faces.size(), 2 * shared::kRowsPerChunk);
  const VisibilitySettings settings{.rays = 6};
  const std::vector<uint32_t> labels = runLabels(s.faces.size(), 7);
  VisibilityRun clearance(device(), s, settings, labels, "clearance");
  const std::vector<Row> rows = clearance.rows();
  oracle::expectSameRows(rows, oracle::visibilityRows(s, settings, labels, clearance.clusterCount));
  const std::vector<uint32_t> words = clearance.rawOutput();
  for (const char* skip : {"bricks", "none"}) EXPECT_EQ(VisibilityRun(device(), s, settings, labels, skip).rawOutput(), words) << skip;
  EXPECT_GT(clearance.harness.figure("visibility", "mrays_per_second"), 0.0);
  EXPECT_EQ(clearance.harness.figure("visibility", "rays"), 6.0 * static_cast<double>(s.faces.size()));
}

TEST_F(VisibilityTest, TwoRunsSameBits) {
  const VoxelStructures s = buildVoxelStructures(oracle::randomSoup(3, 40), 40);
  const std::vector<uint32_t> labels = runLabels(s.faces.size(), 5);
  VisibilityRun run(device(), s, {.rays = 64}, labels);
  const std::vector<uint32_t> words = run.rawOutput();
  EXPECT_EQ(VisibilityRun(device(), s, {.rays = 64}, labels).rawOutput(), words);
  // Running again after a change and back frees and makes all chunks anew.
  run.harness.set("visibility.near", "2");
  EXPECT_NE(run.rawOutput(), words);
  run.harness.set("visibility.near", "8");
  EXPECT_EQ(run.rawOutput(), words);
  EXPECT_EQ(run.harness.runCount("visibility"), 3u);
}

TEST_F(VisibilityTest, SlowGridsOneVoxelThick) {
  // A sheet in a plane of the grid: one voxel across it. Rays leave at once or run along it.
  for (int axis = 0; axis < 3; ++axis) {
    oracle::Soup soup;
    glm::vec3 u(0.f), v(0.f);
    u[(axis + 1) % 3] = 1.f;
    v[(axis + 2) % 3] = 1.f;
    oracle::addQuad(soup, glm::vec3(0.f), u, v);
    const VoxelStructures s = buildVoxelStructures(soup, 9);
    ASSERT_EQ(s.grid.size[axis], 1u);
    for (const char* skip : {"clearance", "bricks", "none"}) checkRows(device(), s, {.rays = 32}, skip);
    checkRows(device(), s, {.rays = 32, .axisFrame = true, .voxelHit = true});
    checkRows(device(), s, {.rays = 32, .bresenham = true, .axisFrame = true});
  }
}

TEST_F(VisibilityTest, EmptySceneHasNoRows) {
  VoxelStructures s = buildVoxelStructures({}, 16);
  if (s.occupancy.empty()) {
    s.grid.size = s.grid.bricks = glm::uvec3(1);
    s.grid.brickCount = 1;
    s.occupancy.resize(1);
  }
  VisibilityRun run(device(), s, {.rays = 16}, {});
  EXPECT_TRUE(run.rows().empty());
  EXPECT_EQ(run.harness.count("entries"), 0u);
}

TEST_F(VisibilityTest, TooManyIdsNameTheResolutionThatFits) {
  const VoxelStructures s = buildVoxelStructures(oracle::roomSoup(), 16);
  std::vector<uint32_t> labels = runLabels(s.faces.size(), 7);
  labels.back() = shared::kMissBase - static_cast<uint32_t>(labels.size()) - 1;  // the last id is kMissBase − 1: it fits
  VisibilityRun(device(), s, {.rays = 2}, labels).rows();
  ++labels.back();
  VisibilityRun run(device(), s, {.rays = 2}, labels);
  try {
    run.harness.run();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::OutOfMemory);
    EXPECT_NE(std::string(error.what()).find("voxelize.resolution=15"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace radivox
