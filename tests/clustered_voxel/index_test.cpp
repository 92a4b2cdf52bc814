// index against brute force: ranks, the list of voxels, and the distance to the nearest occupied brick.
#include "modules/clustered_voxel/index/index.h"

#include <gtest/gtest.h>

#include <random>

#include "modules/clustered_voxel/voxelize/grid.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"
#include "tests/oracles/voxel_structures.h"

namespace radivox {
namespace {

using oracle::VoxelStructures;

class IndexTest : public oracles::GpuTest {
 protected:
  /// Runs the node over s.grid and s.occupancy and holds all it writes against the definition.
  void check(VoxelStructures& s) {
    oracle::indexVoxels(s);
    oracles::NodeHarness harness(device());
    harness.importValue("voxelize.grid", s.grid);
    harness.importBuffer("voxelize.occupancy", s.occupancy);
    harness.setCount("bricks", s.grid.brickCount);
    harness.setCount("voxels", s.voxels.size());
    harness.add<clustered_voxel::Index>("index");
    harness.connect("voxelize.grid", "index.grid");
    harness.connect("voxelize.occupancy", "index.occupancy");
    for (const char* port : {"rank", "voxels", "distance"}) harness.output(std::string("index.") + port);
    harness.run();
    EXPECT_EQ(harness.download<uint32_t>("index.rank", s.rank.size()), s.rank);
    EXPECT_EQ(harness.download<uint32_t>("index.voxels", s.voxels.size()), s.voxels);
    EXPECT_EQ(harness.download<uint32_t>("index.distance", s.distance.size()), s.distance);
  }
  static VoxelStructures emptyGrid(const glm::vec3& extent, uint32_t resolution) {
    VoxelStructures s;
    s.grid = clustered_voxel::makeGrid(glm::vec3(0.f), extent, resolution);
    s.occupancy.assign(s.grid.brickCount, glm::uvec2(0));
    return s;
  }
};

TEST_F(IndexTest, RandomBitsOfAnyDensity) {
  std::mt19937 random(4);
  for (const auto& [extent, resolution] : std::vector<std::pair<glm::vec3, uint32_t>>{
           {{1, 1, 1}, 8}, {{1, 0.4f, 0.07f}, 61}, {{0.2f, 1, 0.9f}, 130}, {{0.01f, 0.02f, 1}, 1024}}) {
    for (const double density : {0.0002, 0.02, 0.5}) {
      SCOPED_TRACE(std::to_string(resolution) + " at " + std::to_string(density));
      VoxelStructures s = emptyGrid(extent, resolution);
      std::bernoulli_distribution hasVoxels(std::min(1.0, 4 * density)), bit(0.25);
      for (glm::uvec2& word : s.occupancy) {
        if (!hasVoxels(random)) continue;
        for (int b = 0; b < 64; ++b)
          if (bit(random)) word[b / 32] |= 1u << (b % 32);
      }
      check(s);
    }
  }
}

TEST_F(IndexTest, OneVoxelFarAway) {
  // 256 bricks in a row: the farthest is 255 bricks away, the most that a byte holds.
  VoxelStructures s = emptyGrid({0.001f, 0.001f, 1.f}, 1024);
  s.occupancy.front().x = 1;
  check(s);
  EXPECT_EQ(s.brickDistance(s.grid.brickCount - 1), s.grid.bricks.z - 1);
}

TEST_F(IndexTest, NoVoxelAtAll) {
  VoxelStructures s = emptyGrid({1, 1, 1}, 40);
  check(s);
  EXPECT_TRUE(s.voxels.empty());
  EXPECT_EQ(s.brickDistance(0), 255u);
}

TEST_F(IndexTest, EveryVoxel) {
  VoxelStructures s = emptyGrid({1, 1, 1}, 32);
  for (glm::uvec2& word : s.occupancy) word = glm::uvec2(~0u);
  check(s);
  EXPECT_EQ(s.voxels.size(), 32u * 32 * 32);
}

}  // namespace
}  // namespace radivox
