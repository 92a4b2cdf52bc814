// Whole pictures against independent path-traced renders (../shared/truth), pixel by pixel, by the noise of both.
#include <algorithm>
#include <cstdio>
#include <numbers>

#include "tests/oracles/form_factors.h"
#include "tests/oracles/light_oracle.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/z_test.h"
#include "tests/reference/reference_fixture.h"

namespace radivox::reference_test {
namespace {

using oracles::ZTest;

struct Comparison {
  ZTest pixels, blocks;
};

class ReferenceTruth : public testing::Test {
 protected:
  void SetUp() override {
    if (oracles::sharedFolder().empty()) GTEST_SKIP() << "no ../shared";
  }

  /// direct and indirect irradiance of one scene at its truth's size.
  std::pair<Comparison, Comparison> compare(const std::string& name, uint32_t bounces, double samplesA, double samplesB, uint32_t spp) {
    const std::string file = name + "_b" + std::to_string(bounces);
    const auto direct = oracles::loadNoisyTruth(file, "irradiance_direct", samplesA, samplesB);
    const auto indirect = oracles::loadNoisyTruth(file, "irradiance_indirect", samplesA, samplesB);
    const scene::Scene scene = scene::loadScene(oracles::sharedFolder() + "/scenes/" + name + ".glb");
    // Passes of 2: many of them, for variances that can be trusted.
    images_ = reference::PathTracer(scene).render(
        scene.cameras[0], {.width = direct.a.width, .height = direct.a.height, .bounces = bounces, .spp = spp, .samplesPerPass = 2});
    std::printf("%s, %u samples a pixel, %.1f s\n", file.c_str(), images_.samples, images_.seconds);
    return {compareOne("direct", direct, images_.irradianceDirect), compareOne("indirect", indirect, images_.irradianceIndirect)};
  }

  reference::Images images_;

 private:
  Comparison compareOne(const char* what, const oracles::NoisyTruth& truth, const reference::Estimate& e) {
    Comparison result;
    result.pixels = oracles::compareWithNoise(truth, e.mean, e.variance, 1);
    result.blocks = oracles::compareWithNoise(truth, e.mean, e.variance, 8);
    for (const auto& [z, kind] : {std::pair(result.pixels, "pixels"), std::pair(result.blocks, "8x8 blocks")}) {
      std::printf(
          "  %-8s %-10s %7zu: |z| < 1.960 for %.2f %%, < 2.576 for %.2f %%, mean z2 %.3f; ratio %.5f +- %.5f, worst region %.3f %%\n", what,
          kind, z.count, 100 * z.within5, 100 * z.within1, z.meanSquare, z.ratio, z.ratioError, 100 * z.worstRegion);
    }
    return result;
  }
};

/// Of normal and unbiased values 99 % pass at 1 % significance. Pixels of few samples are skewed, so a little less is asked of them.
void expectAgreement(const Comparison& comparison, const std::string& what) {
  EXPECT_GT(comparison.pixels.within1, 0.97) << what;
  EXPECT_GT(comparison.blocks.within1, 0.97) << what;
  EXPECT_LT(comparison.blocks.worstRegion, 0.01) << what << ": light of a part of the picture";
  EXPECT_NEAR(comparison.blocks.ratio, 1.0, 0.001 + 3 * comparison.blocks.ratioError) << what;
}

TEST_F(ReferenceTruth, SlowSponzaOneBounce) {
  // Of one bounce most comes by few bright paths: more samples before means are normal.
  const auto [direct, indirect] = compare("sponza", 1, 128, 384, 96);
  expectAgreement(direct, "direct");
  expectAgreement(indirect, "indirect");
}

TEST_F(ReferenceTruth, SlowSponzaEightBounces) {
  const auto [direct, indirect] = compare("sponza", 8, 256, 512, 32);
  expectAgreement(direct, "direct");
  expectAgreement(indirect, "indirect");
}

TEST_F(ReferenceTruth, SlowCornellPoint) {
  for (const uint32_t bounces : {1u, 8u}) {
    const auto [direct, indirect] = compare("cornell_point", bounces, 256, 256, 32);
    expectAgreement(direct, "direct");
    expectAgreement(indirect, "indirect");
  }
}

TEST_F(ReferenceTruth, SlowCornell) {
  for (const uint32_t bounces : {1u, 8u}) {
    const auto [direct, indirect] = compare("cornell", bounces, 256, 256, 16);
    EXPECT_GT(direct.pixels.within1, 0.97);
    EXPECT_NEAR(direct.blocks.ratio, 1.0, 0.006);
    EXPECT_GT(indirect.pixels.within1, 0.97);
    EXPECT_GT(indirect.blocks.within1, 0.97);
    EXPECT_LT(indirect.blocks.worstRegion, 0.01);
    EXPECT_NEAR(indirect.blocks.ratio, 1.0, 0.003);
  }
  // Direct light high on the walls: the independent render is 1 to 3 % too dark there (both of its files alike), which the closed form shows.
  // So there the closed form judges: the back wall above the blocks' reach, where all of the lamp is seen.
  const scene::Scene scene = scene::loadScene(oracles::sharedFolder() + "/scenes/cornell.glb");
  const auto truth = oracles::loadNoisyTruth("cornell_b8", "irradiance_direct", 256, 256);
  const oracles::LightOracle oracle(scene);
  std::vector<glm::dvec3> lamp;
  double radiance = 0;
  for (uint32_t t = 0; t < scene.triangleCount(); ++t) {
    const shared::Material& material = scene.materials[scene.triangleMaterials[t]];
    if ((material.flags & shared::kMaterialEmissive) == 0u) continue;
    radiance = static_cast<double>(material.emission.x);
    for (int k = 0; k < 3; ++k) {
      if (std::find(lamp.begin(), lamp.end(), oracle.corner(t, k)) == lamp.end()) lamp.push_back(oracle.corner(t, k));
    }
  }
  ASSERT_EQ(lamp.size(), 4u);
  // Around the quad, whatever order the triangles name its corners in.
  const glm::dvec3 middle = (lamp[0] + lamp[1] + lamp[2] + lamp[3]) / 4.0;
  std::sort(lamp.begin(), lamp.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(a.z - middle.z, a.x - middle.x) < std::atan2(b.z - middle.z, b.x - middle.x);
  });
  double exact = 0, ours = 0, variance = 0, theirs = 0;
  for (uint32_t y = 116; y < 200; ++y) {
    for (uint32_t x = 112; x < 400; ++x) {
      glm::dvec3 origin, direction;
      oracles::LightOracle::cameraRay(scene.cameras[0], truth.a.width, truth.a.height, x + 0.5, y + 0.5, origin, direction);
      const auto hit = oracle.castRay(origin, direction);
      ASSERT_TRUE(hit);
      glm::dvec3 n = oracle.normal(hit->triangle);
      if (glm::dot(n, direction) > 0) n = -n;
      if (std::abs(n.z) < 0.99) continue;  // the corners of the picture's part show side walls
      exact += std::numbers::pi * radiance * oracles::pointToPolygon(origin + hit->t * direction, n, lamp);
      ours += static_cast<double>(images_.irradianceDirect.mean.at(x, y, 0));
      variance += static_cast<double>(images_.irradianceDirect.variance.at(x, y, 0));
      theirs += 0.5 * static_cast<double>(truth.a.at(x, y, 0) + truth.b.at(x, y, 0));
    }
  }
  std::printf("back wall, direct: ours / closed form %.5f +- %.5f; independent render / closed form %.5f\n", ours / exact,
              std::sqrt(variance) / exact, theirs / exact);
  expectWithin(ours, std::sqrt(variance), exact, "back wall", 1e-3);
}

}  // namespace
}  // namespace radivox::reference_test
