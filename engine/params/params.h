// A parameter is described once and read by all: CLI (`--set node.param=value`), JSON presets, UI, and `radivox report`, which tries the
// values that a parameter says trade time for quality.
//
//   struct VoxelizeParams { uint32_t resolution = 128; Method method = Method::Auto; };
//   params::Table table_{{
//       params::number("resolution", &p_.resolution, {8, 1024}, "voxels along the longest side", Invalidates::Plan),
//       params::choice("method", &p_.method, {"auto", "hardware", "geometry", "compute"}, "…", Invalidates::Plan)}};
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/error.h"

namespace radivox::params {

/// What a change of the value makes stale.
enum class Invalidates {
  Plan,   ///< shapes, ports or pipelines: the graph is compiled again
  Rerun,  ///< the node and what depends on its outputs run again
  Frame,  ///< only the next frame (view settings)
};

enum class Type { Bool, UInt, Float, Choice, Text };

struct Range {
  double min = 0;
  double max = 0;
};

struct Param {
  std::string name;
  Type type = Type::Bool;
  Range range;                       ///< numbers only, inclusive
  std::vector<std::string> choices;  ///< Choice only; the value is the index
  std::string help;                  ///< one line, with the unit
  std::string defaultValue;
  Invalidates invalidates = Invalidates::Rerun;
  std::vector<std::string> sweep;  ///< values that trade time for quality, cheapest first; empty: not what the value is for
  std::string exact;               ///< the value that makes least error of its own, whatever it costs; may lie outside `sweep`
  std::function<std::string()> get;
  std::function<void(double)> setNumber;            ///< already checked; Choice takes the index, Bool 0 or 1
  std::function<void(const std::string&)> setText;  ///< Text only; throws BadInput, without the place, where the text will not do
};

Param flag(std::string name, bool* value, std::string help, Invalidates invalidates);
Param number(std::string name, uint32_t* value, Range range, std::string help, Invalidates invalidates);
Param number(std::string name, float* value, Range range, std::string help, Invalidates invalidates);
Param choiceIndex(std::string name, std::function<uint32_t()> get, std::function<void(uint32_t)> set, std::vector<std::string> names,
                  std::string help, Invalidates invalidates);
/// Any text: a file name, a list of names. `check`, where given, throws BadInput for a text that will not do.
Param text(std::string name, std::string* value, std::string help, Invalidates invalidates,
           std::function<void(const std::string&)> check = {});
/// Enum whose enumerators count from 0 in the order of `names`.
template <class E>
Param choice(std::string name, E* value, std::vector<std::string> names, std::string help, Invalidates invalidates) {
  return choiceIndex(
      std::move(name), [value] { return static_cast<uint32_t>(*value); }, [value](uint32_t i) { *value = static_cast<E>(i); },
      std::move(names), std::move(help), invalidates);
}

/// `param`, which trades time for quality.
Param swept(Param param, std::vector<std::string> values, std::string exact);

/// The parameters of one node. Points into the node, so the node must not move.
class Table {
 public:
  Table() = default;
  explicit Table(std::vector<Param> params) : params_(std::move(params)) {}
  const std::vector<Param>& all() const { return params_; }
  /// Parses and checks. Throws BadInput naming `owner`.name, the value, what is allowed, and the nearest name if unknown.
  /// Returns what became stale. `changed` counts up so that run-on-change nodes notice (only when the value differs).
  Invalidates set(std::string_view owner, std::string_view name, std::string_view text);
  uint64_t version() const { return version_; }          ///< counts Rerun and Plan changes
  uint64_t planVersion() const { return planVersion_; }  ///< counts Plan changes
  /// "name=value" of every parameter, in order; for stats and caches.
  std::string print() const;

 private:
  std::vector<Param> params_;
  uint64_t version_ = 0;
  uint64_t planVersion_ = 0;
};

/// The candidate with the least edit distance, for "did you mean". Empty when none is near (more than half the letters differ).
std::string nearestName(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace radivox::params
