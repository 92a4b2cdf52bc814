// What a plan does without because the scene, the camera or the request does not need it: why, and what it would have cost.
#pragma once

#include <string>
#include <vector>

#include "engine/graph/plan.h"

namespace radivox::graph {

struct LeftOut {
  std::string what;                    ///< "emitters"
  std::string why;                     ///< "nothing in the scene emits"
  std::vector<std::string> nodes;      ///< that would be in the plan
  std::vector<std::string> resources;  ///< of other nodes, that would be made
  uint64_t bytes = 0;                  ///< of the nodes' and the other resources: what is known with `counts`
  bool open = false;                   ///< and more, that only the first run tells
  std::string shaders;                 ///< what pipelines are specialized without; empty: nothing
};

/// One entry a feature of the scene (scene::Feature) that is left out. Compiles `graph` once for each; what its nodes declared last is what
/// `input` says. `counts`: those of input, or of a run.
std::vector<LeftOut> listLeftOut(const Graph& graph, const CompileInput& input, const Counts& counts);
/// "left out" as text, a line each.
std::string printLeftOut(const std::vector<LeftOut>& list);

}  // namespace radivox::graph
