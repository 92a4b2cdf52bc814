// What is stale, from versions.
#include <algorithm>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {

std::string Executor::Impl::missingImports() const {
  std::string missing;
  for (size_t r = 0; r < resources.size(); ++r) {
    if (!plan.resources[r].imported || resources[r].importedBuffer != nullptr || resources[r].importedImage != nullptr) continue;
    missing += (missing.empty() ? "" : ", ") + plan.resources[r].name;
  }
  return missing;
}

void Executor::Impl::requireImports() const {
  const std::string missing = missingImports();
  if (!missing.empty()) throw Error(ErrorCode::BadInput, "the plan reads imports that were not given: " + missing);
}

bool Executor::Impl::isPlanCurrent() const {
  return std::all_of(steps.begin(), steps.end(), [](const StepState& s) { return s.node->params().planVersion() == s.planVersion; });
}

void Executor::Impl::requireCurrentPlan() const {
  for (uint32_t i = 0; i < steps.size(); ++i) {
    if (steps[i].node->params().planVersion() == steps[i].planVersion) continue;
    throw Error(ErrorCode::BadInput, "a parameter of " + nodeName(i) + " changed the plan; compile the graph again");
  }
}

bool Executor::Impl::hasKnownCounts(uint32_t step) const {
  const auto& names = plan.steps[step].neededCounts;
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return counts.count(name) != 0; });
}

/// On its own account: not because of steps before it that will run.
bool Executor::Impl::isStale(uint32_t step, bool nextFrame) const {
  const PlannedStep& planned = plan.steps[step];
  const StepState& state = steps[step];
  if (!state.everRan || state.node->params().version() != state.paramsVersion) return true;
  if (planned.everyFrame && (nextFrame || !state.ranThisFrame)) return true;
  for (size_t p = 0; p < planned.ports.size(); ++p) {
    const PlannedPort& port = planned.ports[p];
    if (port.resource == kNoResource || (port.access != Access::Read && port.access != Access::Modify)) continue;
    const uint32_t link = port.access == Access::Modify ? port.version - 1 : port.version;
    if (resources[port.resource].versions[link] != state.seen[p]) return true;
  }
  for (size_t c = 0; c < planned.neededCounts.size(); ++c) {
    const auto known = counts.find(planned.neededCounts[c]);
    if (known == counts.end() || known->second != state.seenCounts[c]) return true;
  }
  return false;
}

void Executor::Impl::findStale(bool nextFrame) {
  for (uint32_t i = 0; i < steps.size(); ++i) stale[i] = isStale(i, nextFrame) ? 1 : 0;
  // What runs makes its readers run; what modifies makes the writer before it run, unless the memory still holds that version.
  bool changed = true;
  while (changed) {
    changed = false;
    for (uint32_t i = 0; i < steps.size(); ++i) {
      if (stale[i] == 0) continue;
      for (const PlannedPort& port : plan.steps[i].ports) {
        if (port.resource == kNoResource || port.access == Access::Scratch || port.access == Access::ReadBack) continue;
        const bool modifies = port.access == Access::Modify;
        for (uint32_t j = 0; j < steps.size(); ++j) {
          if (stale[j] != 0 || j == i) continue;
          for (const PlannedPort& other : plan.steps[j].ports) {
            if (other.resource != port.resource) continue;
            const bool readsMine = port.access != Access::Read && ((other.access == Access::Read && other.version == port.version) ||
                                                                   (other.access == Access::Modify && other.version == port.version + 1));
            const bool writesBefore = modifies && other.access != Access::Read && other.version + 1 == port.version &&
                                      resources[port.resource].currentLink + 1 != port.version;
            if (readsMine || writesBefore) {
              stale[j] = 1;
              changed = true;
            }
          }
        }
      }
    }
  }
}

}  // namespace radivox::graph
