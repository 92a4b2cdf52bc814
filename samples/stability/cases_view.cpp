// Extreme pictures, cameras and grids.
#include "engine/scene/builtin.h"
#include "samples/stability/cases.h"
#include "samples/stability/scenes.h"

namespace radivox::stability {

namespace {

void runFurnacePicture(Bench& bench, Row& row, uint32_t width, uint32_t height, uint32_t resolution) {
  RenderOptions options = coarse(resolution);
  options.width = width;
  options.height = height;
  options.settings.push_back({"bounce.residual", "1e-7"});
  // One noisy pixel needs the samples of a picture.
  if (width * height == 1) options.settings.push_back({"path_trace.spp", "16384"});
  if (resolution > 256) options.settings.push_back({"visibility.rays", "16"});
  const auto values = bench.render(scene::makeBuiltin("furnace"), options)->surfaceValues("irradiance_indirect");
  row.judge(0.5, meanOf(values), bench.tolerance(2e-4));
  if (!bench.isNoisy()) row.error = values.empty() ? 1e30 : largestFrom(values, 0.5);
}

/// A camera in the middle of the block: it sees the block's dark inside.
void runInsideWall(Bench& bench, Row& row) {
  scene::Scene scene = litRoom();
  scene.cameras = {makeCameraAt({-0.4, -0.5, -0.3}, {-0.3, -0.4, -0.8}, 1.f)};
  expectBlack(bench, row, scene, coarse());
  // Against the room outside, E = 1 W/m² or so.
  row.error /= 0.6 / 3.14159265;
  row.bound = 0.1;
  row.why = "rays of voxels at the block's edges pass beside its corners: the share of the light outside that leaks in";
}

}  // namespace

void addViewCases(Cases& cases) {
  const auto add = [&](const std::string& name, uint32_t width, uint32_t height, uint32_t resolution, bool fast) {
    cases.push_back({.group = "extreme",
                     .name = name,
                     .answer = "E_indirect = 0.5 in every pixel of a furnace",
                     .run = [=](Bench& bench, Row& row) { runFurnacePicture(bench, row, width, height, resolution); },
                     .fast = fast,
                     .mayRefuse = resolution > 256});
  };
  add("a picture of one pixel", 1, 1, 16, true);
  add("a picture of 1000 x 1 pixels", 1000, 1, 16, false);
  add("a picture of 1 x 1000 pixels", 1, 1000, 16, false);
  for (const uint32_t resolution : {8u, 64u, 256u, 1024u}) add("N = " + std::to_string(resolution), 48, 32, resolution, resolution == 8);
  cases.push_back({.group = "extreme", .name = "a camera inside a block", .answer = "black", .run = runInsideWall, .fast = true});
}

}  // namespace radivox::stability
