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

void Executor::Impl::linkSteps() {
  links.resize(resources.size());
  for (ResourceId id = 0; id < resources.size(); ++id) links[id].resize(plan.resources[id].versionCount);
  for (uint32_t i = 0; i < steps.size(); ++i) {
    for (const PlannedPort& port : plan.steps[i].ports) {
      if (port.resource == kNoResource) continue;
      std::vector<VersionLink>& chain = links[port.resource];
      if (port.access == Access::Read) chain[port.version].readers.push_back(i);
      if (port.access == Access::Modify) chain[port.version - 1].readers.push_back(i);
      if (port.access == Access::Write || port.access == Access::Modify) chain[port.version].writer = i;
    }
  }
}

void Executor::Impl::findStale(bool nextFrame) {
  for (uint32_t i = 0; i < steps.size(); ++i) stale[i] = isStale(i, nextFrame) ? 1 : 0;
  bool again = true;
  while (again) {
    again = false;
    for (uint32_t i = 0; i < steps.size(); ++i) {
      if (stale[i] == 0) continue;
      for (const PlannedPort& port : plan.steps[i].ports) {
        if (port.resource == kNoResource || port.access == Access::Scratch || port.access == Access::ReadBack) continue;
        // What runs makes its readers run; they come later in this pass.
        if (port.access != Access::Read) {
          for (const uint32_t reader : links[port.resource][port.version].readers) stale[reader] = 1;
        }
        // What reads makes the writer before it run, unless the memory still holds that version (it was modified, or freed). It comes earlier: another pass.
        if (port.access == Access::Write) continue;
        const uint32_t link = port.access == Access::Modify ? port.version - 1 : port.version;
        if (resources[port.resource].currentLink == link) continue;
        const uint32_t writer = links[port.resource][link].writer;
        if (writer == kNoStep || stale[writer] != 0) continue;
        stale[writer] = 1;
        again = true;
      }
    }
  }
}

}  // namespace radivox::graph
