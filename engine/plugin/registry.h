// Node types by name. A module is one function `void registerNodes(Registry&)`, linked in (a call list that CMake writes) or found in
// a shared library (`extern "C" radivoxModule`, ABI tag checked first).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/graph/node.h"
#include "engine/stability/case.h"

// Count up with every change of a class in engine/graph/node.h, resource.h, engine/params, engine/plugin, engine/gpu or engine/error.h.
#define RADIVOX_ABI_VERSION 3
#define RADIVOX_TEXT_(x) #x
#define RADIVOX_TEXT(x) RADIVOX_TEXT_(x)
#if defined(_LIBCPP_VERSION)
#define RADIVOX_ABI_LIBRARY "libc++ " RADIVOX_TEXT(_LIBCPP_VERSION)
#elif defined(__GLIBCXX__)
#define RADIVOX_ABI_LIBRARY "libstdc++ " RADIVOX_TEXT(__GLIBCXX__) " cxx11=" RADIVOX_TEXT(_GLIBCXX_USE_CXX11_ABI)
#else
#define RADIVOX_ABI_LIBRARY "unknown standard library"
#endif
#ifndef RADIVOX_ABI_TAG  // a build may give another (tests of the refusal)
#define RADIVOX_ABI_TAG \
  "radivox abi " RADIVOX_TEXT(RADIVOX_ABI_VERSION) ", compiler " __VERSION__ ", " RADIVOX_ABI_LIBRARY ", C++ " RADIVOX_TEXT(__cplusplus)
#endif

namespace radivox::plugin {

/// The tag this engine was built with. It changes whenever a class that crosses the boundary changes (RADIVOX_ABI_VERSION, counted by
/// hand), and carries compiler and standard library. A module carries the tag of *its* build: the macro, not this function.
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

  /// A case of `radivox stability` that the module brings. Throws BadInput when its method, group and name are taken together.
  void addStabilityCase(stability::Case stabilityCase);
  const std::vector<stability::Case>& stabilityCases() const { return stabilityCases_; }

 private:
  std::vector<NodeType> types_;
  std::vector<stability::Case> stabilityCases_;
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
/// Defines the entry point only where the module becomes a library of its own (radivox_add_module), so that many link into one program.
#ifdef RADIVOX_SHARED_MODULE
#define RADIVOX_MODULE(function)                                                                          \
  extern "C" __attribute__((visibility("default"))) const radivox::plugin::ModuleEntry* radivoxModule() { \
    static const radivox::plugin::ModuleEntry entry{RADIVOX_ABI_TAG, &(function)};                        \
    return &entry;                                                                                        \
  }
#else
#define RADIVOX_MODULE(function) static_assert(true)
#endif
