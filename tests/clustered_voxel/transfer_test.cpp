// The cluster matrix against sums in double over the same rows.
#include "modules/clustered_voxel/visibility/transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shaders/shared/transfer_entry.h"
#include "tests/oracles/cluster_oracle.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox {
namespace {

struct Random {
  std::mt19937 engine;
  uint32_t operator()() { return static_cast<uint32_t>(engine()); }
};

/// Faces in clusters, and rows that see anything: made up, so that every kind of entry occurs.
struct Case {
  std::vector<shared::Face> faces;
  std::vector<uint32_t> labels;
  uint32_t clusterCount = 0;
  oracle::VisibilityRows rows;
  std::vector<uint32_t> weights;  ///< empty: by area

  /// Faces whose area is what they count for.
  std::vector<shared::Face> weighted() const {
    std::vector<shared::Face> result = faces;
    std::vector<uint64_t> sums(clusterCount);
    for (size_t s = 0; s < weights.size(); ++s) sums[labels[s]] += weights[s];
    for (size_t s = 0; s < weights.size(); ++s) {
      if (sums[labels[s]] > 0) result[s].area = static_cast<float>(weights[s]);
    }
    return result;
  }
};

Case makeCase(uint32_t faceCount, uint32_t clusterCount, uint32_t entriesPerRow, uint32_t seed, bool closed = false) {
  Random random{std::mt19937(seed)};
  Case c;
  c.clusterCount = clusterCount;
  for (uint32_t s = 0; s < faceCount; ++s) {
    shared::Face face{};
    face.area = std::exp2(-12.f * static_cast<float>(random()) / 4294967296.f);  // from slivers to whole faces
    c.faces.push_back(face);
    c.labels.push_back(s < clusterCount ? s : random() % clusterCount);
    std::map<uint32_t, uint32_t> row;
    for (uint32_t rays = 128; rays > 0;) {
      const uint32_t kind = closed ? random() % 8 : random() % 10;
      const uint32_t id = kind < 6    ? random() % clusterCount
                          : kind < 8  ? clusterCount + random() % faceCount
                          : kind == 8 ? shared::kMissBase + random() % shared::kSkyBinCount
                                      : shared::kAbsorbed;
      const uint32_t count = std::min(rays, 1 + random() % (2 * 128 / entriesPerRow));
      row[id] += count;
      rays -= count;
    }
    c.rows.emplace_back(row.begin(), row.end());
  }
  return c;
}

class TransferTest : public oracles::GpuTest {
 protected:
  struct Output {
    std::vector<uint32_t> rowStart;
    std::vector<uint32_t> entries;
    uint32_t weightBits = 0;
    std::vector<float> sky;
  };
  Output transfer(const Case& c, const std::string& lanes = "auto") {
    oracle::VoxelStructures s;
    s.faces = c.faces;
    s.voxels.assign(c.faces.size(), 0);
    for (uint32_t i = 0; i < s.faces.size(); ++i) s.faces[i].key = i << 3;
    const auto packed = oracle::packRows(c.rows, c.clusterCount + static_cast<uint32_t>(c.faces.size()));
    std::vector<gpu::Buffer> chunks;
    std::vector<uint64_t> table;
    for (const auto& chunk : packed.chunks) {
      chunks.emplace_back(device(), "chunk", chunk.size() * 4);
      if (!chunk.empty()) gpu::upload(device(), chunks.back(), chunk);
      table.push_back(chunks.back().address());
    }
    oracles::NodeHarness h(device());
    h.importBuffer("in.row_start", packed.rowStart);
    h.importBuffer("in.entries", packed.chunks.empty() ? std::vector<uint32_t>{0} : packed.chunks[0]);
    h.importBuffer("in.chunk_table", table);
    h.importBuffer("in.faces", c.faces);
    h.importBuffer("in.labels", c.labels);
    h.importBuffer("in.clusters", oracle::describeClusters(s, c.labels, c.clusterCount).clusters);
    h.importBuffer("in.members", oracle::listMembers(c.labels, c.clusterCount));
    h.setCount("faces", c.faces.size());
    h.setCount("clusters", c.clusterCount);
    h.add<clustered_voxel::Transfer>("transfer");
    h.set("transfer.lanes", lanes);
    h.connect("in.row_start", "transfer.visibility_row_start");
    h.connect("in.entries", "transfer.visibility_entries");
    for (const char* port : {"chunk_table", "faces", "labels", "clusters", "members"})
      h.connect(std::string("in.") + port, std::string("transfer.") + port);
    if (!c.weights.empty()) {
      h.importBuffer("in.weights", c.weights);
      h.connect("in.weights", "transfer.weights");
    }
    for (const char* port : {"row_start", "entries", "sky"}) h.output(std::string("transfer.") + port);
    h.run();
    Output out;
    out.rowStart = h.download<uint32_t>("transfer.row_start", c.clusterCount + 1);
    out.sky = h.download<float>("transfer.sky", c.clusterCount);
    out.entries = h.downloadGrown<uint32_t>("transfer.entries").at(0);
    out.entries.resize(h.count("transfer_entries"));
    out.weightBits = shared::transferWeightBits(c.clusterCount);
    EXPECT_EQ(out.rowStart.back(), out.entries.size());
    return out;
  }

  void check(const Case& c) {
    const Output out = transfer(c, "64");
    const Output few = transfer(c, "8");
    EXPECT_EQ(out.rowStart, few.rowStart);
    EXPECT_EQ(out.entries, few.entries);
    EXPECT_EQ(out.sky, few.sky);
    const oracle::SparseMatrix expected = oracle::clusterTransfer(c.rows, c.weighted(), c.labels, c.clusterCount);
    const double unit = std::exp2(-static_cast<double>(out.weightBits));
    double worst = 0, worstSum = 0;
    for (uint32_t i = 0; i < c.clusterCount; ++i) {
      ASSERT_EQ(out.rowStart[i + 1] - out.rowStart[i], expected.rows[i].size()) << "row " << i;
      double sum = static_cast<double>(out.sky[i]), expectedSum = expected.sky[i];
      auto column = expected.rows[i].begin();
      for (uint32_t e = out.rowStart[i]; e < out.rowStart[i + 1]; ++e, ++column) {
        ASSERT_EQ(shared::transferColumn(out.entries[e], out.weightBits), column->first) << "row " << i;
        const double weight = shared::transferUnits(out.entries[e], out.weightBits) * unit;
        worst = std::max(worst, std::abs(weight - column->second));
        sum += weight;
        expectedSum += column->second;
      }
      worst = std::max(worst, std::abs(static_cast<double>(out.sky[i]) - expected.sky[i]));
      worstSum = std::max(worstSum, std::abs(sum - expectedSum));
    }
    // Beside the units, weights are integers of 31 bits. What is lost on backs is rounded, too.
    EXPECT_LT(worst, unit + 1e-8);
    EXPECT_LT(worstSum, unit + 1e-8);
    std::printf("[ figures  ] %u clusters, %zu entries, largest error %.2e, of a row sum %.2e\n", c.clusterCount, out.entries.size(), worst,
                worstSum);
  }
};

TEST_F(TransferTest, EqualsSumsInDouble) { check(makeCase(3000, 150, 40, 1)); }
TEST_F(TransferTest, OneCluster) { check(makeCase(700, 1, 20, 2)); }
TEST_F(TransferTest, EveryFaceACluster) { check(makeCase(300, 300, 30, 3)); }
TEST_F(TransferTest, SlowMoreColumnsThanABatch) { check(makeCase(12000, 2000, 200, 10)); }
TEST_F(TransferTest, SeveralChunks) { check(makeCase(2 * shared::kRowsPerChunk + 100, 700, 8, 4)); }
// 65536 columns are one window; that many rows take a while.
TEST_F(TransferTest, SlowMoreColumnsThanAWindow) { check(makeCase(70000, 66000, 4, 5)); }

TEST_F(TransferTest, FacesCountByTheirWeights) {
  Case c = makeCase(3000, 150, 40, 8);
  Random random{std::mt19937(9)};
  for (size_t s = 0; s < c.faces.size(); ++s)
    c.weights.push_back(c.labels[s] % 10 == 0 || random() % 4 == 0 ? 0 : random() >> random() % 32);
  check(c);
}

TEST_F(TransferTest, ClosedRowsSumToOne) {
  const Case c = makeCase(2000, 120, 40, 6, true);
  const Output out = transfer(c);
  for (uint32_t i = 0; i < c.clusterCount; ++i) {
    uint32_t sum = 0;
    for (uint32_t e = out.rowStart[i]; e < out.rowStart[i + 1]; ++e) sum += shared::transferUnits(out.entries[e], out.weightBits);
    EXPECT_EQ(out.sky[i], 0.f);
    EXPECT_EQ(sum, 1u << out.weightBits);
  }
}

TEST_F(TransferTest, TwoRunsGiveTheSameBits) {
  const Case c = makeCase(3000, 80, 40, 7);
  const Output a = transfer(c), b = transfer(c);
  EXPECT_EQ(a.rowStart, b.rowStart);
  EXPECT_EQ(a.entries, b.entries);
  EXPECT_EQ(a.sky, b.sky);
}

TEST_F(TransferTest, NothingGivesNoRows) {
  const Output out = transfer(Case{});
  EXPECT_TRUE(out.entries.empty());
}

}  // namespace
}  // namespace radivox
