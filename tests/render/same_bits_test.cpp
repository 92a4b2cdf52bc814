// The same input gives the same bits, a hundred times over.
#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/scene/builtin.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

class SameBits : public oracles::GpuTest {};

// RADIVOX_SAME_BITS_RUNS=100 takes five minutes.
TEST_F(SameBits, SlowManyRuns) {
  const char* wanted = std::getenv("RADIVOX_SAME_BITS_RUNS");
  const int runs = wanted != nullptr ? std::atoi(wanted) : 12;
  ASSERT_GT(runs, 1);
  oracles::PipelineOptions options;
  options.settings = {{"voxelize.resolution", "16"}, {"visibility.rays", "32"}};
  options.width = 32;
  options.height = 24;
  options.lights = {.shadowResolution = 64, .pointShadowResolution = 64, .emitterSamples = 8, .emitterShadowResolution = 64};
  options.outputs = {"composite.color", "surface.faces", "cluster.labels", "transfer.row_start", "bounce.face_radiosity"};
  const scene::Scene scene = scene::makeBuiltin("cornell");
  std::vector<float> picture;
  std::vector<std::vector<uint32_t>> buffers;
  for (int run = 0; run < runs; ++run) {
    oracles::Pipeline p(oracles::sharedDevice(), scene, options);
    p.run();
    std::vector<std::vector<uint32_t>> now;
    for (size_t i = 1; i < options.outputs.size(); ++i) now.push_back(p.buffer<uint32_t>(options.outputs[i]));
    if (run == 0) {
      picture = p.picture("composite.color").data;
      buffers = now;
    }
    ASSERT_EQ(p.picture("composite.color").data, picture) << "run " << run;
    for (size_t i = 0; i < now.size(); ++i) ASSERT_EQ(now[i], buffers[i]) << options.outputs[i + 1] << ", run " << run;
  }
}

}  // namespace
}  // namespace radivox
