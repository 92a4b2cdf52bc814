// What a scene's pictures are judged against: files, or our own path tracer, whose state is kept between runs.
#pragma once

#include <optional>

#include "engine/image/flip.h"
#include "engine/scene/scene.h"
#include "samples/cli/layers.h"
#include "samples/report/clock.h"
#include "samples/report/row.h"

namespace radivox::report {

struct TruthOptions {
  std::vector<std::string> files;  ///< one or two; empty: the path tracer
  double shareOfA = 0.5;           ///< of the files' samples
  uint32_t width = 0, height = 0, bounces = scene::kAllBounces;
  std::string cacheFolder;    ///< of path-traced references
  double targetError = 0.03;  ///< relative noise (reference::relativeError) at which the path tracer stops
  double timeLimit = 600;     ///< seconds that it may take
  Progress progress;
  std::function<bool()> cancelled;  ///< true: stop for good
};

struct SceneTruth {
  cli::LayerTruth full;                  ///< color
  cli::LayerTruth indirect;              ///< irradiance_indirect
  std::string about;                     ///< "path tracer, 256 samples a pixel, all bounces"
  std::string key;                       ///< of its content
  std::vector<cli::PictureFile> halves;  ///< where the path tracer made it
  double shareOfA = 0.5;
  float exposureFull = 1.f, exposureIndirect = 1.f;
  /// Relative RMSE of the reference's own noise; 0 where it has no halves.
  double floorFull = 0, floorIndirect = 0;
};

/// Throws BadInput (files), Unsupported (no path tracer in this build), cli::Interrupted; what was traced until then is kept.
SceneTruth findTruth(const scene::Scene& scene, const scene::CameraDescription& camera, const TruthOptions& options);

struct Judgement {
  ErrorFigures figures;
  image::Image flip;  ///< one channel
};
/// Pixels that the truth leaves out are made 0 in `test`.
Judgement judge(const cli::LayerTruth& truth, float exposure, image::Image& test, bool wantsHdr);

/// A picture of the path tracer's at some number of samples; what it took.
struct TracedPicture {
  image::Image color, indirect;
  double buildSeconds = 0, seconds = 0;
};
/// Empty when cancelled. Throws Unsupported without a path tracer.
std::optional<TracedPicture> tracePicture(const scene::Scene& scene, const scene::CameraDescription& camera, const TruthOptions& options,
                                          uint32_t samples);
bool hasPathTracer();

}  // namespace radivox::report
