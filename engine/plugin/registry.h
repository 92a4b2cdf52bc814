// Node types by name. A module is one function `void registerNodes(Registry&)`, linked in (a call list that CMake writes) or found in
// a shared library (`extern "C" radivoxModule`, ABI tag checked first).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace radivox::graph {
class Node;
}

namespace radivox::plugin {

/// Changes whenever a class that crosses the boundary changes; also carries compiler and standard library.
std::string_view abiTag();

struct NodeType {
  std::string name;  ///< "clustered_voxel.voxelize"
  std::string help;  ///< one line
  std::function<std::unique_ptr<graph::Node>()> make;
  std::string origin;  ///< "linked in" or the library's path
};

class Registry {
 public:
  /// Throws BadInput when the name is taken, naming both origins.
  void add(std::string name, std::string help, std::function<std::unique_ptr<graph::Node>()> make);
  template <class N>
  void add(std::string help) {
    add(std::string(N::kType), std::move(help), [] { return std::make_unique<N>(); });
  }
  /// Loads a module library. Throws BadInput (not found, no entry point, other ABI tag: prints both). Nodes keep the library alive.
  void load(const std::string& path);
  /// Throws BadInput with the nearest name.
  std::unique_ptr<graph::Node> make(std::string_view type) const;
  const std::vector<NodeType>& types() const { return types_; }

 private:
  std::vector<NodeType> types_;
  std::string origin_ = "linked in";
  std::shared_ptr<void> library_;
};

/// What a module library exports.
struct ModuleEntry {
  const char* abiTag;
  void (*registerNodes)(Registry&);
};

}  // namespace radivox::plugin

/// In one source file of a module:  RADIVOX_MODULE(registerClusteredVoxel)
#define RADIVOX_MODULE(function)                                                                                 \
  extern "C" __attribute__((visibility("default"))) const radivox::plugin::ModuleEntry* radivoxModule() {       \
    static const radivox::plugin::ModuleEntry entry{radivox::plugin::abiTag().data(), &(function)};              \
    return &entry;                                                                                               \
  }
