// Which settings are worth having: nothing measured is both cheaper and better.
#pragma once

#include <functional>
#include <vector>

#include "samples/report/row.h"

namespace radivox::report {

/// Indices of the points that no other dominates (no more of either coordinate, and less of one), by ascending x. Equal points: the first.
std::vector<size_t> paretoFront(const std::vector<std::pair<double, double>>& points);

/// Sets the four flags of every row: a first picture's time, or every frame's, against relative RMSE of the full picture, or of indirect
/// light. The path tracer, whose time is not split, stands aside.
void markFronts(std::vector<Row*>& rows);

}  // namespace radivox::report
