// The bounce solver against closed forms, a dense solve in double, and counted steps.
#include "modules/clustered_voxel/bounce/bounce.h"

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

/// A matrix with all that goes with it; every cluster has two faces of different area and albedo.
struct Case {
  oracle::SparseMatrix matrix;
  std::vector<shared::Cluster> clusters;
  std::vector<float> areas;  ///< of clusters
  std::vector<uint32_t> labels, members;
  std::vector<shared::Face> faces;
  std::vector<glm::vec3> emission, faceIrradiance, directRadiosity;
  uint32_t clusterCount() const { return static_cast<uint32_t>(clusters.size()); }
  std::vector<double> channel(const std::vector<glm::vec3>& values, int k) const {
    std::vector<double> out;
    for (const glm::vec3& v : values) out.push_back(static_cast<double>(v[k]));
    return out;
  }
  std::vector<double> albedo(int k) const {
    std::vector<double> out;
    for (const shared::Cluster& c : clusters) out.push_back(static_cast<double>(c.albedo[k]));
    return out;
  }
};

/// Form factors as entries of the node's matrix hold them: rounded in running sums.
void roundToUnits(oracle::SparseMatrix& matrix) {
  const double units = std::exp2(shared::transferWeightBits(static_cast<uint32_t>(matrix.rows.size())));
  for (auto& row : matrix.rows) {
    double sum = 0;
    for (auto& [j, w] : row) {
      const double before = std::round(sum * units);
      sum += w;
      w = (std::round(sum * units) - before) / units;
    }
  }
}

double uniform(Random& random) { return random() / 4294967296.0; }

/// Rows of `entryCount` random columns that sum to 1 − sky.
Case randomCase(uint32_t clusterCount, uint32_t entryCount, double darkest, double brightest, double mostSky, uint32_t seed) {
  Random random{std::mt19937(seed)};
  Case c;
  c.matrix.rows.resize(clusterCount);
  for (uint32_t i = 0; i < clusterCount; ++i) {
    double sum = 0;
    for (uint32_t e = 0; e < entryCount; ++e) sum += c.matrix.rows[i][random() % clusterCount] = uniform(random) + 0.01;
    sum = 0;
    for (const auto& [j, w] : c.matrix.rows[i]) sum += w;
    const double sky = mostSky * uniform(random);
    for (auto& [j, w] : c.matrix.rows[i]) w *= (1.0 - sky) / sum;
    c.matrix.sky.push_back(sky);
    shared::Cluster cluster{};
    glm::vec3 albedo[2];
    for (glm::vec3& a : albedo)
      for (int k = 0; k < 3; ++k) a[k] = static_cast<float>(darkest + (brightest - darkest) * uniform(random));
    const float area[2] = {0.3f, 1.1f};
    const float whole = area[0] + area[1];
    c.areas.push_back(whole);
    cluster.firstMember = 2 * i;
    glm::vec3 weighted(0.f), direct(0.f);
    for (int f = 0; f < 2; ++f) {
      shared::Face face{};
      face.key = (2 * i + static_cast<uint32_t>(f)) << 3;
      face.area = area[f];
      face.albedo = shared::encodeAlbedo(albedo[f]);
      albedo[f] = shared::decodeAlbedo(face.albedo);
      c.faces.push_back(face);
      c.labels.push_back(i);
      c.members.push_back(2 * i + static_cast<uint32_t>(f));
      const bool lit = random() % 5 == 0;
      c.faceIrradiance.push_back(lit ? glm::vec3(3.f, 2.f, 0.f) * static_cast<float>(uniform(random)) : glm::vec3(0.f));
      c.emission.push_back(random() % 7 == 0 ? glm::vec3(0.f, 1.f, 5.f) * static_cast<float>(uniform(random)) : glm::vec3(0.f));
      weighted += area[f] * albedo[f];
      direct += area[f] * albedo[f] * c.faceIrradiance.back();
    }
    cluster.albedo = weighted / whole;
    c.clusters.push_back(cluster);
    c.directRadiosity.push_back(direct / whole);
  }
  roundToUnits(c.matrix);
  return c;
}

/// Every cluster sees all others alike and receives 1 W/m² directly: B = ρ / (1 − ρ).
Case uniformBox(uint32_t clusterCount, float albedo) {
  Case c = randomCase(clusterCount, 1, 0, 0, 0, 1);
  for (uint32_t i = 0; i < clusterCount; ++i) {
    c.matrix.rows[i].clear();
    c.matrix.sky[i] = 0;
    for (uint32_t j = 0; j < clusterCount; ++j)
      if (j != i) c.matrix.rows[i][j] = 1.0 / (clusterCount - 1);
    c.clusters[i].albedo = glm::vec3(albedo);
    c.directRadiosity[i] = glm::vec3(albedo);
  }
  for (size_t s = 0; s < c.faces.size(); ++s) {
    c.faces[s].albedo = shared::encodeAlbedo(glm::vec3(albedo));
    c.faceIrradiance[s] = glm::vec3(1.f);
  }
  roundToUnits(c.matrix);
  return c;
}

class BounceTest : public oracles::GpuTest {
 protected:
  struct Output {
    std::vector<glm::vec3> clusters, faces;
    double iterations = 0, residual = 0, fallback = 0, stopReason = 0;
  };
  Output solve(const Case& c, uint32_t bounces = scene::kAllBounces, bool emission = false,
               const std::map<std::string, std::string>& settings = {}) {
    scene::Traits traits;
    traits.emittersByRays = emission;
    scene::Request request;
    request.bounces = bounces;
    std::vector<uint32_t> rowStart{0};
    std::vector<uint32_t> entries;
    const uint32_t weightBits = shared::transferWeightBits(c.clusterCount());
    for (uint32_t i = 0; i < c.clusterCount(); ++i) {
      for (const auto& [j, w] : c.matrix.rows[i])
        entries.push_back(shared::packTransferEntry(j, static_cast<uint32_t>(std::ldexp(w, static_cast<int>(weightBits))), weightBits));
      rowStart.push_back(static_cast<uint32_t>(entries.size()));
    }
    oracles::NodeHarness h(device(), traits, request);
    h.importBuffer("in.row_start", rowStart);
    h.importBuffer("in.entries", entries);
    std::vector<shared::Cluster> clusters = c.clusters;
    clusters.push_back({glm::vec3(0.f), static_cast<uint32_t>(c.members.size())});
    h.importBuffer("in.clusters", clusters);
    h.importBuffer("in.members", c.members);
    h.importBuffer("in.labels", c.labels);
    h.importBuffer("in.faces", c.faces);
    h.importBuffer("in.emission", c.emission);
    h.importBuffer("in.face_irradiance", c.faceIrradiance);
    h.importBuffer("in.direct_radiosity", c.directRadiosity);
    h.setCount("clusters", c.clusters.size());
    h.setCount("faces", c.faces.size());
    h.add<clustered_voxel::Bounce>("bounce");
    for (const char* port :
         {"row_start", "entries", "clusters", "members", "labels", "faces", "emission", "face_irradiance", "direct_radiosity"})
      h.connect(std::string("in.") + port, std::string("bounce.") + port);
    for (const auto& [name, value] : settings) h.set("bounce." + name, value);
    for (const char* port : {"cluster_radiosity", "face_radiosity", "status"}) h.output(std::string("bounce.") + port);
    h.run();
    Output out;
    out.clusters = h.download<glm::vec3>("bounce.cluster_radiosity", c.clusters.size());
    out.faces = h.download<glm::vec3>("bounce.face_radiosity", c.faces.size());
    out.iterations = h.figure("bounce", "iterations");
    out.residual = h.figure("bounce", "residual");
    out.fallback = h.figure("bounce", "fallback");
    out.stopReason = h.figure("bounce", "stop_reason");
    return out;
  }

  static double largest(const std::vector<double>& values) {
    double most = 0;
    for (double v : values) most = std::max(most, std::abs(v));
    return most;
  }
  static std::vector<double> times(const oracle::SparseMatrix& f, const std::vector<double>& x) {
    std::vector<double> y(x.size());
    for (size_t i = 0; i < x.size(); ++i)
      for (const auto& [j, w] : f.rows[i]) y[i] += w * x[j];
    return y;
  }

  /// Cluster and face radiosity of all channels against `radiosity` per channel; `received` is what faces get beside direct light.
  static void expectNear(const Case& c, const Output& out, int k, const std::vector<double>& radiosity, const std::vector<double>& received,
                         double tolerance) {
    const double scale = largest(radiosity);
    double worst = 0;
    for (uint32_t i = 0; i < c.clusterCount(); ++i)
      worst = std::max(worst, std::abs(static_cast<double>(out.clusters[i][k]) - radiosity[i]) / scale);
    EXPECT_LT(worst, tolerance) << "clusters, channel " << k;
    double worstFace = 0;
    for (size_t s = 0; s < c.faces.size(); ++s) {
      const double expected = static_cast<double>(shared::decodeAlbedo(c.faces[s].albedo)[k]) *
                              (static_cast<double>(c.faceIrradiance[s][k]) + received[c.labels[s]]);
      worstFace = std::max(worstFace, std::abs(static_cast<double>(out.faces[s][k]) - expected) / scale);
    }
    EXPECT_LT(worstFace, tolerance) << "faces, channel " << k;
  }

  void checkConverged(const Case& c, const Output& out, double tolerance, bool emission = false) {
    for (int k = 0; k < 3; ++k) {
      std::vector<double> source = c.channel(c.directRadiosity, k), fromEmitters(c.clusters.size());
      if (emission) {
        std::vector<double> mean(c.clusters.size());
        for (size_t s = 0; s < c.faces.size(); ++s)
          mean[c.labels[s]] += static_cast<double>(c.faces[s].area * c.emission[s][k]) / static_cast<double>(c.areas[c.labels[s]]);
        fromEmitters = times(c.matrix, mean);
        for (size_t i = 0; i < source.size(); ++i) source[i] += c.albedo(k)[i] * fromEmitters[i];
      }
      if (largest(source) == 0) continue;
      const auto solution = oracle::solveRadiosity(c.matrix, c.albedo(k), source);
      auto received = times(c.matrix, solution);
      for (size_t i = 0; i < received.size(); ++i) received[i] += fromEmitters[i];
      expectNear(c, out, k, solution, received, tolerance);
    }
  }
};

TEST_F(BounceTest, ClosedBoxComesToItsClosedForm) {
  for (float albedo : {0.f, 0.5f, 0.9f, 0.99f, 0.999f}) {
    const Case c = uniformBox(60, albedo);
    const Output out = solve(c);
    const double expected = static_cast<double>(albedo) / (1.0 - static_cast<double>(albedo));
    // A residual of 2⁻²³ B is let stand, and F and the residual itself are rounded: 1 / (1 − ρ) times that is the error.
    const double tolerance = std::max(1e-6, 1.5 * std::exp2(-23) / (1.0 - static_cast<double>(albedo))) * std::max(expected, 1e-3);
    double worst = 0;
    for (const glm::vec3& b : out.clusters)
      for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(static_cast<double>(b[k]) - expected));
    EXPECT_LE(worst, tolerance) << "albedo " << albedo;
    EXPECT_EQ(out.stopReason, shared::kStopResidual);
    EXPECT_EQ(out.fallback, 0);
    EXPECT_LE(out.residual, 1e-6);
    EXPECT_LT(out.iterations, 500);
    std::printf("[ figures  ] albedo %.3f: %.0f iterations, residual %.1e, relative error %.1e\n", static_cast<double>(albedo),
                out.iterations, out.residual, expected > 0 ? worst / expected : worst);
  }
}

TEST_F(BounceTest, RandomMatricesEqualADenseSolve) {
  for (double brightest : {0.3, 0.8, 0.95, 0.999}) {
    const Case c = randomCase(300, 40, 0.0, brightest, 0.3, 5);
    const Output out = solve(c);
    checkConverged(c, out, 5e-6);
    EXPECT_EQ(out.stopReason, shared::kStopResidual);
    std::printf("[ figures  ] albedo up to %.3f: %.0f iterations, residual %.1e\n", brightest, out.iterations, out.residual);
  }
}

TEST_F(BounceTest, FewWhiteClustersCostLittle) {
  // Two white clusters in a grey scene: max ρ says stiff, the bound by successive residuals knows better.
  Case c = randomCase(300, 40, 0.3, 0.5, 0.0, 6);
  for (uint32_t i = 0; i < 2; ++i) c.clusters[i].albedo = glm::vec3(0.999f);
  const Output out = solve(c);
  checkConverged(c, out, 1.0);  // faces keep their own albedo here; clusters are compared below
  for (int k = 0; k < 2; ++k) {
    const auto solution = oracle::solveRadiosity(c.matrix, c.albedo(k), c.channel(c.directRadiosity, k));
    for (uint32_t i = 0; i < c.clusterCount(); ++i) EXPECT_NEAR(out.clusters[i][k], solution[i], 5e-6 * largest(solution));
  }
  EXPECT_LT(out.iterations, 40);
}

TEST_F(BounceTest, EmittersByRaysAreDirectLight) {
  const Case c = randomCase(200, 30, 0.1, 0.9, 0.2, 7);
  const Output out = solve(c, scene::kAllBounces, true);
  checkConverged(c, out, 5e-6, true);
  // And are not when they light through samples.
  const Output without = solve(c, scene::kAllBounces, false);
  checkConverged(c, without, 5e-6, false);
}

TEST_F(BounceTest, CountedBouncesAreCounted) {
  const Case c = randomCase(150, 25, 0.2, 0.95, 0.1, 8);
  for (uint32_t bounces : {1u, 2u, 3u, 8u}) {
    const Output out = solve(c, bounces);
    EXPECT_EQ(out.iterations, bounces - 1);
    for (int k = 0; k < 2; ++k) {
      const auto source = c.channel(c.directRadiosity, k);
      const auto albedo = c.albedo(k);
      auto b = source;
      std::vector<double> received(source.size());
      for (uint32_t n = 1; n < bounces; ++n) {
        received = times(c.matrix, b);
        for (size_t i = 0; i < b.size(); ++i) b[i] = source[i] + albedo[i] * received[i];
      }
      expectNear(c, out, k, b, received, 1e-6);
    }
  }
}

TEST_F(BounceTest, OneBounceFromEmittersByRays) {
  const Case c = randomCase(100, 20, 0.2, 0.9, 0.1, 9);
  const Output out = solve(c, 1, true);
  EXPECT_EQ(out.iterations, 0);
  for (int k = 0; k < 3; ++k) {
    std::vector<double> mean(c.clusters.size());
    for (size_t s = 0; s < c.faces.size(); ++s)
      mean[c.labels[s]] += static_cast<double>(c.faces[s].area * c.emission[s][k]) / static_cast<double>(c.areas[c.labels[s]]);
    const auto received = times(c.matrix, mean);
    auto b = c.channel(c.directRadiosity, k);
    for (size_t i = 0; i < b.size(); ++i) b[i] += c.albedo(k)[i] * received[i];
    expectNear(c, out, k, b, received, 1e-6);
  }
}

TEST_F(BounceTest, MoreBouncesThanIterationsIsAnError) {
  const Case c = randomCase(10, 3, 0.2, 0.9, 0.1, 10);
  try {
    solve(c, 12, false, {{"iterations", "10"}});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::BadInput);
    EXPECT_NE(std::string(e.what()).find("bounce.iterations"), std::string::npos) << e.what();
  }
}

TEST_F(BounceTest, PlainIterationAgreesAndTakesLonger) {
  const Case c = randomCase(200, 30, 0.9, 0.97, 0.0, 11);
  const Output fast = solve(c), plain = solve(c, scene::kAllBounces, false, {{"solver", "plain"}});
  checkConverged(c, fast, 2e-5);
  checkConverged(c, plain, 5e-5);
  EXPECT_GT(plain.iterations, 2 * fast.iterations);
}

TEST_F(BounceTest, FallsBackWhereEigenvaluesAreNotReal) {
  // Light goes round in a ring: the eigenvalues of F are the n-th roots of one, all on the unit circle.
  Case c = uniformBox(64, 0.9f);
  for (uint32_t i = 0; i < 64; ++i) c.matrix.rows[i] = {{(i + 1) % 64, 1.0}};
  for (uint32_t i = 0; i < 64; ++i) c.directRadiosity[i] = i == 0 ? glm::vec3(1.f) : glm::vec3(0.f);
  c.faceIrradiance.assign(c.faces.size(), glm::vec3(0.f));
  const Output out = solve(c);
  EXPECT_EQ(out.fallback, 1);
  EXPECT_EQ(out.stopReason, shared::kStopResidual);
  const auto solution = oracle::solveRadiosity(c.matrix, c.albedo(0), c.channel(c.directRadiosity, 0));
  for (uint32_t i = 0; i < 64; ++i) EXPECT_NEAR(out.clusters[i].x, solution[i], 2e-5);
}

TEST_F(BounceTest, DarknessStaysDark) {
  Case c = randomCase(50, 10, 0.5, 0.9, 0.0, 12);
  c.directRadiosity.assign(c.clusters.size(), glm::vec3(0.f));
  c.faceIrradiance.assign(c.faces.size(), glm::vec3(0.f));
  const Output out = solve(c);
  for (const glm::vec3& b : out.clusters) EXPECT_EQ(b, glm::vec3(0.f));
  for (const glm::vec3& b : out.faces) EXPECT_EQ(b, glm::vec3(0.f));
  EXPECT_EQ(out.stopReason, shared::kStopResidual);
}

TEST_F(BounceTest, TwoRunsGiveTheSameBits) {
  const Case c = randomCase(1000, 60, 0.2, 0.99, 0.1, 13);
  const Output a = solve(c), b = solve(c);
  EXPECT_EQ(a.clusters, b.clusters);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.iterations, b.iterations);
}

TEST_F(BounceTest, NothingToSolve) {
  const Output out = solve(Case{});
  EXPECT_TRUE(out.clusters.empty());
  EXPECT_EQ(out.iterations, 0);
}

}  // namespace
}  // namespace radivox
