#include "tests/clustered_voxel/visibility_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "modules/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/visibility_row.h"

namespace radivox::oracle {
namespace {

uint32_t countOf(const std::vector<uint32_t>& labels) {
  uint32_t count = 0;
  for (const uint32_t label : labels) count = std::max(count, label + 1);
  return count;
}

std::string print(const Row& row) {
  std::string text;
  for (const auto& [id, n] : row) text += " " + std::to_string(id) + ":" + std::to_string(n);
  return text;
}

scene::Traits traitsOf(const VisibilitySettings& settings) {
  scene::Traits traits;
  traits.sky = traits.skyImage = settings.skyImage;
  return traits;
}

}  // namespace

std::vector<uint32_t> runLabels(size_t faceCount, uint32_t size) {
  std::vector<uint32_t> labels(faceCount);
  for (size_t i = 0; i < faceCount; ++i) labels[i] = static_cast<uint32_t>(i) / size;
  return labels;
}

VisibilityRun::VisibilityRun(gpu::Device& device, const VoxelStructures& s, const VisibilitySettings& settings,
                             std::vector<uint32_t> faceLabels, const std::string& skip)
    : labels(std::move(faceLabels)), clusterCount(countOf(labels)), harness(device, traitsOf(settings)), faceCount_(s.faces.size()) {
  harness.add<clustered_voxel::Visibility>("visibility");
  harness.importValue("in.grid", s.grid);
  // A buffer of nothing cannot be bound: the empty scene imports one spare element.
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
  harness.setCount("faces", faceCount_);
  harness.setCount("clusters", clusterCount);
  harness.setCount("voxels", s.voxels.size());
  harness.set("visibility.rays", std::to_string(settings.rays));
  harness.set("visibility.traversal", settings.bresenham ? "bresenham" : "dda");
  harness.set("visibility.frame", settings.axisFrame ? "axis" : "normal");
  harness.set("visibility.hit", settings.voxelHit ? "voxel" : "plane");
  harness.set("visibility.near", std::to_string(settings.near));
  harness.set("visibility.skip", skip);
  for (const char* port : {"row_start", "entries", "chunk_table", "clearance", "weights"})
    harness.output(std::string("visibility.") + port);
}

std::vector<Row> VisibilityRun::rows() {
  harness.run();
  const auto starts = harness.download<uint32_t>("visibility.row_start");
  const auto chunks = harness.downloadGrown<uint32_t>("visibility.entries");
  const auto table = harness.download<uint64_t>("visibility.chunk_table");
  const auto buffers = harness.executor().findGrown("visibility.entries");
  for (size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    EXPECT_EQ(table.at(chunk), buffers[chunk]->address());
  }
  size_t entries = 0;
  std::vector<Row> all(faceCount_);
  for (size_t s = 0; s < faceCount_; ++s) {
    const size_t chunk = s / shared::kRowsPerChunk, slot = s + chunk;
    EXPECT_LE((starts.at(slot + 1) + 31) / 32 + shared::kRowPadding, chunks.at(chunk).size());
    const auto idCount = static_cast<uint32_t>(clusterCount + faceCount_);
    shared::forEachRowEntry(chunks.at(chunk).data(), starts.at(slot), starts.at(slot + 1), idCount, [&](uint32_t id, uint32_t count) {
      EXPECT_TRUE(all[s].emplace(id, count).second) << "an id twice in row " << s;
      ++entries;
    });
  }
  EXPECT_EQ(harness.count("entries"), entries);
  return all;
}

std::vector<uint32_t> VisibilityRun::rawOutput() {
  harness.run();
  auto words = harness.download<uint32_t>("visibility.row_start");
  for (const auto& chunk : harness.downloadGrown<uint32_t>("visibility.entries")) words.insert(words.end(), chunk.begin(), chunk.end());
  return words;
}

void expectSameRows(const std::vector<Row>& actual, const std::vector<Row>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  size_t different = 0, first = 0;
  for (size_t i = actual.size(); i-- > 0;) {
    if (actual[i] == expected[i]) continue;
    ++different;
    first = i;
  }
  if (different > 0) {
    ADD_FAILURE() << different << " of " << actual.size() << " rows differ; row " << first << ":" << print(actual[first]) << " instead of"
                  << print(expected[first]);
  }
}

void expectWholeRows(const std::vector<Row>& rows, uint32_t rays) {
  for (const Row& row : rows) {
    uint32_t sum = 0;
    for (const auto& [id, n] : row) sum += n;
    ASSERT_EQ(sum, rays);
  }
}

std::vector<Row> checkRows(gpu::Device& device, const VoxelStructures& s, const VisibilitySettings& settings, const std::string& skip) {
  VisibilityRun run(device, s, settings, runLabels(s.faces.size(), 7), skip);
  const std::vector<Row> rows = run.rows();
  expectSameRows(rows, visibilityRows(s, settings, run.labels, run.clusterCount));
  expectWholeRows(rows, settings.rays);
  EXPECT_EQ(run.harness.download<uint32_t>("visibility.weights", s.faces.size()), seenWeights(s, settings));
  return rows;
}

Soup roomSoup() {
  Soup soup;
  addQuad(soup, {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  addQuad(soup, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  addQuad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  addQuad(soup, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  addQuad(soup, {1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  addBox(soup, {0.55f, 0.f, 0.5f}, {0.85f, 0.31f, 0.82f}, glm::vec3(0.5f), false);
  const glm::vec3 c(0.2f, 0.f, 0.2f), u(0.27f, 0.f, 0.1f), v(-0.1f, 0.f, 0.27f), w(0.f, 0.6f, 0.f);
  addQuad(soup, c, w, u);
  addQuad(soup, c + v, u, w);
  addQuad(soup, c, v, w);
  addQuad(soup, c + u, w, v);
  addQuad(soup, c + w, v, u);
  return soup;
}

Soup randomSoup(uint32_t seed, uint32_t triangles) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * (1.f / 16777216.f); };
  const auto point = [&] {
    const float x = unit(), y = unit(), z = unit();
    return glm::vec3(x, y, z);
  };
  Soup soup(triangles);
  for (SoupTriangle& t : soup) {
    const glm::vec3 center = point();
    for (glm::vec3& p : t.position) p = center + 0.25f * (point() - 0.5f);
    t.doubleSided = (random() & 1u) != 0;
  }
  return soup;
}

void addSphere(Soup& soup, const glm::vec3& center, float radius, uint32_t rings) {
  const auto at = [&](uint32_t ring, uint32_t sector) {
    const double polar = std::numbers::pi * ring / rings, azimuth = std::numbers::pi * (sector % (2 * rings)) / rings;
    return center + radius * glm::vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
  };
  for (uint32_t ring = 0; ring < rings; ++ring) {
    for (uint32_t sector = 0; sector < 2 * rings; ++sector) {
      if (ring > 0) soup.push_back({.position = {at(ring, sector), at(ring, sector + 1), at(ring + 1, sector)}});
      if (ring + 1 < rings) soup.push_back({.position = {at(ring + 1, sector), at(ring, sector + 1), at(ring + 1, sector + 1)}});
    }
  }
}

}  // namespace radivox::oracle
