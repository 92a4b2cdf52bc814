// Direct irradiance against the independent path-traced renders.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/truth.h"

namespace radivox {
namespace {

class FrameTruthTest : public oracles::GpuTest {
 protected:
  void compare(const std::string& name, double weightA, double leastPsnr) {
    const std::string folder = oracles::sharedFolder();
    if (folder.empty()) GTEST_SKIP() << "no ../shared";
    const oracles::Truth truth = oracles::loadTruth(name + "_b1", weightA);
    frame_test::FrameOptions options;
    options.width = truth.direct.width;
    options.height = truth.direct.height;
    options.outputs = {"direct.irradiance", "gbuffer.albedo"};
    frame_test::FrameRun run(device(), scene::loadScene(folder + "/scenes/" + name + ".glb"), options);
    const image::Image direct = run.picture("direct.irradiance");
    frame_test::show(direct, name + "_direct");
    frame_test::show(truth.direct, name + "_truth");
    const oracles::Difference difference = oracles::compareToTruth(truth.direct, direct, truth.albedo);
    std::printf("%s: irradiance_direct %.2f dB, bias %.4f\n", name.c_str(), difference.psnr, difference.bias);
    EXPECT_GT(difference.psnr, leastPsnr);
    EXPECT_NEAR(difference.bias, 1.0, 0.02);
    const oracles::Difference albedo = oracles::compareToTruth(truth.albedo, run.picture("gbuffer.albedo"), truth.albedo);
    EXPECT_GT(albedo.psnr, 30.0) << "the camera does not look where the truth's did";
  }
};

TEST_F(FrameTruthTest, CornellPoint) { compare("cornell_point", 0.5, 30.0); }
TEST_F(FrameTruthTest, SlowCornellEmitter) { compare("cornell", 0.5, 30.0); }
TEST_F(FrameTruthTest, SponzaSun) { compare("sponza", 0.25, 30.0); }

}  // namespace
}  // namespace radivox
