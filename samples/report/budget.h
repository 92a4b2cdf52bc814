// Settings for a time or an error: measured on the scene itself, not guessed.
#pragma once

#include <optional>
#include <string>

#include "samples/cli/options.h"

namespace radivox::report {

struct Budget {
  std::optional<double> maxError;      ///< relative RMSE of color, over the mean of the reference
  std::optional<double> milliseconds;  ///< of a first picture, all stages, pipelines ready
  double calibrationSeconds = 120;     ///< for the reference and for trying settings together
};

struct Choice {
  cli::Options options;  ///< the setting, applied
  std::string text;      ///< one line: the setting, its error and time, and how many were tried
};

/// The fastest setting whose measured error is at most `maxError`, or the best one that takes at most `milliseconds`; with both, the fastest of the
/// first kind, if it is of the second too. What is measured once is kept beside the compiled pipelines and holds for this program, device, scene,
/// camera, size and reference. Throws Unsupported where nothing that was tried keeps the budget, naming what came nearest; cli::Interrupted.
Choice chooseSetting(const cli::Options& options, const Budget& budget);

}  // namespace radivox::report
