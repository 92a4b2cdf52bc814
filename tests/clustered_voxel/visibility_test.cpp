// clustered_voxel.visibility against the CPU traversal (rows, bit for bit), closed-form factors, and exact rays.
#include "modules/clustered_voxel/visibility/visibility.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/clearance.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"
#include "tests/oracles/traversal_oracle.h"

namespace radivox {
namespace {

using oracle::Soup;
using oracle::VisibilitySettings;
using oracle::VoxelStructures;
using Row = std::map<uint32_t, uint32_t>;

class VisibilityTest : public oracles::GpuTest {};

/// Clusters for tests: faces in runs of `size`.
std::vector<uint32_t> runLabels(size_t faceCount, uint32_t size) {
  std::vector<uint32_t> labels(faceCount);
  for (size_t i = 0; i < faceCount; ++i) labels[i] = static_cast<uint32_t>(i) / size;
  return labels;
}

struct NodeRun {
  NodeRun(gpu::Device& device, const VoxelStructures& s, const VisibilitySettings& settings, const std::string& skip = "clearance",
          uint32_t clusterSize = 7)
      : faceCount(s.faces.size()), labels(runLabels(s.faces.size(), clusterSize)), harness(device) {
    clusterCount = labels.empty() ? 0 : labels.back() + 1;
    harness.add<clustered_voxel::Visibility>("visibility");
    harness.importValue("in.grid", s.grid);
    // A buffer of nothing cannot be bound: tests of the empty scene import one spare element.
    const auto import = [&](const std::string& name, auto data) {
      if (data.empty()) data.resize(1);
      harness.importBuffer("in." + name, data);
    };
    import("occupancy", s.occupancy);
    import("rank", s.rank);
    import("voxels", s.voxels);
    import("distance", s.distance);
    import("mask", s.mask);
    import("first", s.first);
    import("faces", s.faces);
    import("labels", labels);
    for (const char* port : {"grid", "occupancy", "rank", "voxels", "distance", "mask", "first", "faces", "labels"}) {
      harness.connect(std::string("in.") + port, std::string("visibility.") + port);
    }
    harness.setCount("faces", faceCount);
    harness.setCount("clusters", clusterCount);
    harness.setCount("voxels", s.voxels.size());
    harness.set("visibility.rays", std::to_string(settings.rays));
    harness.set("visibility.traversal", settings.bresenham ? "bresenham" : "dda");
    harness.set("visibility.frame", settings.axisFrame ? "axis" : "normal");
    harness.set("visibility.hit", settings.voxelHit ? "voxel" : "plane");
    harness.set("visibility.near", std::to_string(settings.near));
    harness.set("visibility.skip", skip);
    for (const char* port : {"row_start", "entries", "chunk_table", "clearance"}) harness.output(std::string("visibility.") + port);
    harness.run();
  }

  std::vector<Row> rows() {
    const auto starts = harness.download<uint32_t>("visibility.row_start");
    const auto chunks = harness.downloadGrown<uint32_t>("visibility.entries");
    std::vector<Row> all(faceCount);
    for (size_t s = 0; s < faceCount; ++s) {
      const size_t chunk = s / shared::kRowsPerChunk, slot = s + chunk;
      for (uint32_t e = starts[slot]; e < starts[slot + 1]; ++e) {
        const uint32_t entry = chunks.at(chunk).at(e);
        const bool fresh = all[s].emplace(entry & shared::kEntryIdMask, (entry >> 24) + 1).second;
        EXPECT_TRUE(fresh) << "an id twice in row " << s;
      }
    }
    return all;
  }

  size_t faceCount;
  std::vector<uint32_t> labels;
  uint32_t clusterCount = 0;
  oracles::NodeHarness harness;
};

/// Rows of the node and of the oracle, which must be equal.
std::vector<Row> checkRows(gpu::Device& device, const VoxelStructures& s, const VisibilitySettings& settings,
                           const std::string& skip = "clearance") {
  NodeRun run(device, s, settings, skip);
  const std::vector<Row> rows = run.rows();
  const std::vector<Row> expected = oracle::visibilityRows(s, settings, run.labels, run.clusterCount);
  size_t different = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] == expected[i]) continue;
    if (different++ == 0) {
      std::string text;
      for (const auto& [id, n] : rows[i]) text += " " + std::to_string(id) + ":" + std::to_string(n);
      text += " instead of";
      for (const auto& [id, n] : expected[i]) text += " " + std::to_string(id) + ":" + std::to_string(n);
      ADD_FAILURE() << "row " << i << ":" << text;
    }
  }
  EXPECT_EQ(different, 0u) << "of " << rows.size() << " rows";
  for (const Row& row : rows) {
    uint32_t sum = 0;
    for (const auto& [id, n] : row) sum += n;
    EXPECT_EQ(sum, settings.rays);
  }
  return rows;
}

/// A room with two boxes in it, one turned: like the Cornell box, open to the front.
Soup room() {
  Soup soup;
  oracle::addQuad(soup, {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  oracle::addQuad(soup, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  oracle::addQuad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  oracle::addQuad(soup, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  oracle::addQuad(soup, {1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  oracle::addBox(soup, {0.55f, 0.f, 0.5f}, {0.85f, 0.31f, 0.82f}, glm::vec3(0.5f), false);
  const glm::vec3 u(0.27f, 0.f, 0.1f), v(-0.1f, 0.f, 0.27f), w(0.f, 0.6f, 0.f), c(0.2f, 0.f, 0.2f);
  oracle::addQuad(soup, c, w, u);
  oracle::addQuad(soup, c + v, u, w);
  oracle::addQuad(soup, c, v, w);
  oracle::addQuad(soup, c + u, w, v);
  oracle::addQuad(soup, c + w, v, u);
  return soup;
}

Soup randomSoup(uint32_t seed, uint32_t triangles) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.f, 1.f);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  Soup soup(triangles);
  for (auto& t : soup) {
    const glm::vec3 center = point();
    for (glm::vec3& p : t.position) p = center + 0.25f * (point() - 0.5f);
    t.doubleSided = (random() & 1u) != 0;
  }
  return soup;
}

TEST_F(VisibilityTest, RowsEqualTheCpuTraversal) {
  for (const uint32_t n : {16u, 32u}) checkRows(device(), oracle::buildVoxelStructures(room(), n), {.rays = 32});
}

TEST_F(VisibilityTest, RandomSoupsAndOneSidedSurfaces) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const VoxelStructures s = oracle::buildVoxelStructures(randomSoup(seed, 24), 12 + 5 * seed, seed % 2 == 0);
    const std::vector<Row> rows = checkRows(device(), s, {.rays = 48, .near = 4.f});
    uint32_t absorbed = 0;
    for (const Row& row : rows) absorbed += row.count(shared::kAbsorbed) != 0 ? 1 : 0;
    EXPECT_EQ(absorbed > 0, seed % 2 == 1);
  }
}

}  // namespace
}  // namespace radivox
