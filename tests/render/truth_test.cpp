// Whole pictures against independent path-traced renders. The figures are printed, so that a run tells how good it was, and bounded below
// by what the method reached when they were last looked at.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/truth.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

class Truth : public oracles::GpuTest {};

struct Quality {
  oracles::Difference full, direct, indirect;
};

Quality measure(const std::string& sceneName, const oracles::Truth& truth, PipelineOptions options) {
  options.width = truth.color.width;
  options.height = truth.color.height;
  const std::string indirect = options.graph == "clustered_voxel_pixels" ? "gather_pixels.irradiance" : "shade.irradiance";
  options.outputs = {"composite.color", "direct.irradiance", indirect};
  Pipeline p(oracles::sharedDevice(), scene::loadScene(oracles::sharedFolder() + "/scenes/" + sceneName), options);
  p.run();
  Quality q;
  q.full = oracles::compareToTruth(truth.color, p.picture("composite.color"), truth.albedo);
  q.direct = oracles::compareToTruth(truth.direct, p.picture("direct.irradiance"), truth.albedo);
  q.indirect = oracles::compareToTruth(truth.indirect, p.picture(indirect), truth.albedo);
  std::printf("%-18s N=%-4s full %.2f dB (bias %.3f)  direct %.2f dB (%.3f)  indirect %.2f dB (%.3f), floor %.2f dB\n", sceneName.c_str(),
              options.settings.front().second.c_str(), q.full.psnr, q.full.bias, q.direct.psnr, q.direct.bias, q.indirect.psnr,
              q.indirect.bias, truth.noiseFloorIndirect);
  return q;
}

PipelineOptions at(uint32_t resolution, uint32_t bounces) {
  PipelineOptions options;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}};
  options.bounces = bounces;
  return options;
}

TEST_F(Truth, SlowCornellBoxes) {
  if (oracles::sharedFolder().empty()) GTEST_SKIP() << "no ../shared";
  for (const char* name : {"cornell", "cornell_point"}) {
    const oracles::Truth eight = oracles::loadTruth(std::string(name) + "_b8", 0.5);
    const oracles::Truth one = oracles::loadTruth(std::string(name) + "_b1", 0.5);
    double previous = 0;
    for (const uint32_t n : {32u, 64u, 128u}) {
      const Quality q = measure(std::string(name) + ".glb", eight, at(n, scene::kAllBounces));
      if (previous > 0) {
        EXPECT_NEAR(q.indirect.bias, previous, 0.03) << n;
      }
      previous = q.indirect.bias;
      EXPECT_GT(q.full.psnr, 37.5);
    }
    const Quality first = measure(std::string(name) + ".glb", one, at(64, 1));
    EXPECT_NEAR(first.indirect.bias, 1.0, 0.06);
  }
}

TEST_F(Truth, SlowSponza) {
  if (oracles::sharedFolder().empty()) GTEST_SKIP() << "no ../shared";
  const oracles::Truth eight = oracles::loadTruth("sponza_b8", 256.0 / 768.0);
  const Quality q = measure("sponza.glb", eight, at(128, scene::kAllBounces));
  EXPECT_GT(q.full.psnr, 33.5);
  EXPECT_GT(q.direct.psnr, 34.5);
  EXPECT_GT(q.indirect.psnr, 27.0);
  // Some light is still lost where surfaces pass through each other, and near sunlit edges, when irradiance is interpolated over voxels.
  EXPECT_GT(q.indirect.bias, 0.94);
  EXPECT_LT(q.indirect.bias, 1.05);
}

TEST_F(Truth, SlowSponzaByPixels) {
  if (oracles::sharedFolder().empty()) GTEST_SKIP() << "no ../shared";
  const oracles::Truth eight = oracles::loadTruth("sponza_b8", 256.0 / 768.0);
  double previous = 0;
  for (const uint32_t n : {64u, 128u}) {
    PipelineOptions options = at(n, scene::kAllBounces);
    options.graph = "clustered_voxel_pixels";
    const Quality q = measure("sponza.glb", eight, options);
    EXPECT_GT(q.indirect.psnr, std::max(33.5, previous));  // error falls as N rises
    previous = q.indirect.psnr;
    EXPECT_NEAR(q.indirect.bias, 1.0, 0.02);
    if (n < 128) continue;
    EXPECT_GT(q.full.psnr, 37.5);
    EXPECT_GT(q.indirect.psnr, 34.5);
  }
}

}  // namespace
}  // namespace radivox
