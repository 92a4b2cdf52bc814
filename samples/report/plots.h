// Plots by gnuplot, as SVG that can stand within a page.
#pragma once

#include "samples/report/results.h"

namespace radivox::report {

enum class TimeAxis { Total, Frame };
enum class Part { Full, Indirect };

struct TimePlot {
  std::string svg;
  // Both axes are logarithmic: from xMin at `left` to xMax at `right` and so on, in the units of the SVG's viewBox.
  double xMin = 1, xMax = 10, yMin = 1, yMax = 10;
  double left = 0, right = 1, top = 0, bottom = 1;
};

/// Relative RMSE against time: every row, the front, the path tracer, the noise floor.
TimePlot plotErrorAgainstTime(const Results& results, const SceneResults& scene, TimeAxis axis, Part part);
/// Relative RMSE of indirect light with one parameter at a time at its most exact. Empty where there is no such row.
std::string plotStages(const Results& results, const SceneResults& scene, const Row& asIs);
/// Time per node: a scene's, a light's and a frame's part.
std::string plotNodes(const Results& results, const SceneResults& scene, const Row& row);
/// The largest resources.
std::string plotMemory(const Results& results, const SceneResults& scene, const Row& row);

}  // namespace radivox::report
