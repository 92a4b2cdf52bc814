// Sky light of voxel faces against sums over rows that are made up, so that every kind of entry occurs.
#include "modules/clustered_voxel/sky/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/oracles/cluster_oracle.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox {
namespace {

constexpr double kPi = 3.14159265358979323846;

oracle::VisibilityRows makeRows(uint32_t faceCount, uint32_t clusterCount, uint32_t seed) {
  std::mt19937 random(seed);
  oracle::VisibilityRows rows;
  for (uint32_t s = 0; s < faceCount; ++s) {
    std::map<uint32_t, uint32_t> row;
    for (uint32_t rays = s % 7 == 0 ? 0 : 1 + static_cast<uint32_t>(random()) % 256; rays > 0; --rays) {
      const auto kind = random() % 10;
      const auto pick = static_cast<uint32_t>(random());
      row[kind < 3   ? pick % clusterCount
          : kind < 5 ? clusterCount + pick % faceCount
          : kind < 9 ? shared::kMissBase + pick % shared::kSkyBinCount
                     : shared::kAbsorbed] += 1;
    }
    rows.emplace_back(row.begin(), row.end());
  }
  return rows;
}

class SkyTest : public oracles::GpuTest {
 protected:
  void check(const std::vector<glm::vec3>& bins);
};

TEST_F(SkyTest, IsTheMeanOverTheRowsMisses) { check({}); }

TEST_F(SkyTest, BinsHaveTheRadianceOfTheirPartOfTheImage) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> radiance(0.f, 50.f);
  std::vector<glm::vec3> bins;
  for (uint32_t b = 0; b < shared::kSkyBinCount; ++b) bins.emplace_back(radiance(random), radiance(random), radiance(random));
  check(bins);
}

void SkyTest::check(const std::vector<glm::vec3>& bins) {
  // Two chunks of rows, the second begun.
  const uint32_t faceCount = shared::kRowsPerChunk + 100, clusterCount = 37;
  const oracle::VisibilityRows rows = makeRows(faceCount, clusterCount, 1);
  const oracle::PackedRows packed = oracle::packRows(rows, clusterCount + faceCount);
  std::vector<gpu::Buffer> chunks;
  std::vector<uint64_t> table;
  for (const auto& chunk : packed.chunks) {
    chunks.emplace_back(device(), "chunk", chunk.size() * 4);
    gpu::upload(device(), chunks.back(), chunk);
    table.push_back(chunks.back().address());
  }
  shared::SceneInfo info{};
  info.skyRadiance = {0.5f, 1.f, 200.f};
  scene::Traits traits;
  traits.sky = true;
  traits.skyImage = !bins.empty();
  oracles::NodeHarness h(device(), traits);
  h.importBuffer("in.row_start", packed.rowStart);
  h.importBuffer("in.entries", packed.chunks[0]);
  h.importBuffer("in.chunk_table", table);
  h.importValue("scene.info", info);
  if (!bins.empty()) h.importBuffer("scene.sky", bins);
  h.setCount("faces", faceCount);
  h.setCount("clusters", clusterCount);
  h.add<clustered_voxel::Sky>("sky");
  for (const char* port : {"row_start", "entries", "chunk_table"}) h.connect(std::string("in.") + port, std::string("sky.") + port);
  h.output("sky.irradiance");
  h.run();
  const auto irradiance = h.download<glm::vec3>("sky.irradiance", faceCount);
  for (uint32_t s = 0; s < faceCount; ++s) {
    double rays = 0;
    glm::dvec3 sum(0);
    for (const auto& [id, count] : rows[s]) {
      rays += count;
      if (id < shared::kMissBase || id >= shared::kAbsorbed) continue;
      sum += static_cast<double>(count) * glm::dvec3(info.skyRadiance);
      if (!bins.empty()) sum += static_cast<double>(count) * glm::dvec3(bins[id - shared::kMissBase]);
    }
    for (glm::length_t c = 0; c < 3; ++c) {
      const double expected = rays > 0 ? kPi * sum[c] / rays : 0.0;
      ASSERT_NEAR(static_cast<double>(irradiance[s][c]), expected, 1e-6 * expected) << s;
    }
  }
}

}  // namespace
}  // namespace radivox
