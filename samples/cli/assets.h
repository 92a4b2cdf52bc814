// Graphs and presets: those of samples/graphs and samples/presets, which the build puts into the binary, or files of the user's.
#pragma once

#include <string>
#include <vector>

namespace radivox::cli {

struct Asset {
  std::string name;
  std::string text;  ///< JSON
};
const std::vector<Asset>& graphs();
const std::vector<Asset>& presets();

struct Source {
  std::string text;
  std::string name;    ///< "clustered_voxel", "my_graph"
  std::string source;  ///< for errors: "graph clustered_voxel" or the file's path
};
/// A name, or a path (holds a '/' or ends with .json). Throws BadInput with the nearest name.
Source findGraph(const std::string& nameOrFile);
Source findPreset(const std::string& nameOrFile);

/// "unknown KIND 'NAME'; did you mean 'X'?" and the list of what there is. Throws it as BadInput.
[[noreturn]] void failUnknown(const std::string& kind, const std::string& name, const std::vector<std::string>& candidates);

}  // namespace radivox::cli
