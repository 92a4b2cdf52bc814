// What .vdb and .nvdb files hold, and how two of them differ: whoever wrote them.
#pragma once

#include <functional>
#include <string>

namespace radivox::vdb {

/// Asked between grids; what it throws ends the work.
using Checkpoint = std::function<void(double fraction)>;

/// Text, a line a grid. Throws BadInput for files that cannot be read.
std::string printFile(const std::string& file, const Checkpoint& checkpoint = {});

struct Difference {
  std::string text;
  bool identical = false;  ///< the same grids, places, active voxels and values; metadata apart
};
/// Grid by grid, by name: voxels that only one file has, the largest and the mean difference of values.
Difference diffFiles(const std::string& a, const std::string& b, const Checkpoint& checkpoint = {});

}  // namespace radivox::vdb
