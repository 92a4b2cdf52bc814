// One setting, run and judged.
#pragma once

#include "samples/report/sweep.h"
#include "samples/report/truth.h"

namespace radivox::report {

struct Bench {
  gpu::Device& device;
  const scene::Scene& scene;
  const scene::CameraDescription& camera;
  const SceneTruth& truth;
  std::string pictures;             ///< folder for KEY.color.png, .color_error.png, .indirect.png, .indirect_error.png
  std::function<bool()> cancelled;  ///< gives the row up
  Progress progress;
};

/// Cost and errors of `job`, which was prepared from the setting; writes the pictures. Throws Error(BadInput, "interrupted") when cancelled.
void measure(const Bench& bench, cli::Job& job, Row& row);

/// The same for what the path tracer made.
void judgePictures(const Bench& bench, image::Image color, image::Image indirect, Row& row);

}  // namespace radivox::report
