// Resources with version chains and lifetimes; aliasing of scratch memory; barriers.
#include <algorithm>
#include <map>
#include <set>

#include "engine/graph/compile.h"

namespace radivox::graph {
namespace detail {
namespace {

class Layout {
 public:
  Layout(const Draft& draft, Plan& plan) : draft_(draft), plan_(plan) {
    for (const auto& declaration : draft.declarations) written_.emplace_back(declaration.ports.size());
  }

  PlannedPort plan(uint32_t node, uint32_t p, uint32_t position) {
    const Port& port = draft_.declarations[node].ports[p];
    PlannedPort planned{port.name, kNoResource, 0, port.access, port.use, port.meaning, port.frees};
    if (isInput(port)) {
      if (!draft_.reads(node, p)) return planned;
      const Source& source = draft_.sources[node][p];
      const Value value = source.node != kNone ? written_[source.node][source.port] : importValue(source.importIndex);
      planned.resource = value.resource;
      planned.version = value.version;
      if (port.access == Access::Modify) {
        planned.version = value.version + 1;
        plan_.resources[value.resource].versionCount = planned.version + 1;
      }
    } else {
      if (!draft_.exists(node, p)) return planned;
      planned.resource = addResource(draft_.portName(node, p), port);
    }
    written_[node][p] = {planned.resource, planned.version};
    PlannedResource& resource = plan_.resources[planned.resource];
    resource.firstUse = std::min(resource.firstUse, position);
    resource.lastUse = std::max(resource.lastUse, position);
    for (const Endpoint& output : draft_.graph.outputs()) {
      if (output.print() == draft_.portName(node, p)) resource.output = true;
    }
    return planned;
  }

 private:
  struct Value {
    ResourceId resource = kNoResource;
    uint32_t version = 0;
  };

  ResourceId addResource(std::string name, const Port& port) {
    PlannedResource resource;
    resource.name = std::move(name);
    resource.shape = port.shape;
    resource.persistent = port.persistent;
    resource.growable = port.growable;
    resource.hostVisible = port.access == Access::ReadBack;
    resource.scratch = port.access == Access::Scratch;
    resource.meaning = port.meaning;
    resource.firstUse = kNone;
    plan_.resources.push_back(std::move(resource));
    return static_cast<ResourceId>(plan_.resources.size() - 1);
  }

  Value importValue(uint32_t index) {
    const auto known = imports_.find(index);
    if (known != imports_.end()) return {known->second, 0};
    PlannedResource resource;
    resource.name = draft_.input.imports[index].name;
    resource.shape = draft_.input.imports[index].shape;
    resource.imported = true;
    resource.meaning = "import";
    resource.firstUse = kNone;
    plan_.resources.push_back(std::move(resource));
    const auto id = static_cast<ResourceId>(plan_.resources.size() - 1);
    imports_.emplace(index, id);
    return {id, 0};
  }

  const Draft& draft_;
  Plan& plan_;
  std::vector<std::vector<Value>> written_;
  std::map<uint32_t, ResourceId> imports_;
};

/// Size to rank scratch resources by while counts are unknown. Only the order matters.
uint64_t guessBytes(const Shape& shape, const Counts& known) {
  constexpr uint64_t kUnknownCount = 100000;
  Counts counts = known;
  const auto assume = [&](const Extent& extent) {
    for (const std::string& name : extent.counts()) counts.emplace(name, kUnknownCount);
  };
  if (shape.kind == ResourceKind::Buffer) {
    assume(shape.elements);
    return shape.elements.evaluate(counts).value_or(0) * shape.elementBytes;
  }
  assume(shape.width);
  assume(shape.height);
  assume(shape.layers);
  return shape.width.evaluate(counts).value_or(0) * shape.height.evaluate(counts).value_or(0) * shape.layers.evaluate(counts).value_or(0);
}

/// Steps that run again whenever step `first` has run, even after a frame that broke off between: what reads its outputs, and so on.
std::vector<char> followers(const Plan& plan, uint32_t first) {
  std::vector<char> follows(plan.steps.size(), 0);
  std::set<std::pair<ResourceId, uint32_t>> renewed;
  for (uint32_t i = first; i < plan.steps.size(); ++i) {
    const std::vector<PlannedPort>& ports = plan.steps[i].ports;
    follows[i] = i == first || std::any_of(ports.begin(), ports.end(), [&](const PlannedPort& port) {
                   const bool reads = port.access == Access::Read || port.access == Access::Modify;
                   return reads && renewed.count({port.resource, port.version - (port.access == Access::Modify ? 1 : 0)}) != 0;
                 });
    if (follows[i] == 0) continue;
    for (const PlannedPort& port : ports) {
      if (port.access == Access::Write || port.access == Access::Modify) renewed.emplace(port.resource, port.version);
    }
  }
  follows[first] = 0;
  return follows;
}

/// Until a follower has written its output, nobody may read that output's memory: scratch may lie there.
void lend(Plan& plan, uint32_t step) {
  const std::vector<char> follows = followers(plan, step);
  std::set<ResourceId> lent;
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (port.access != Access::Scratch || port.resource == kNoResource) continue;
    PlannedResource& scratch = plan.resources[port.resource];
    for (uint32_t i = step + 1; i < plan.steps.size() && scratch.lender == kNoResource; ++i) {
      if (follows[i] == 0) continue;
      for (const PlannedPort& later : plan.steps[i].ports) {
        if (later.access != Access::Write || later.resource == kNoResource || lent.count(later.resource) != 0) continue;
        const PlannedResource& output = plan.resources[later.resource];
        const bool plain = output.shape.kind == ResourceKind::Buffer && !output.persistent && !output.growable && !output.hostVisible;
        if (!plain || output.shape.print() != scratch.shape.print()) continue;
        scratch.lender = later.resource;
        lent.insert(later.resource);
        break;
      }
    }
  }
}

}  // namespace

Plan layOut(const Draft& draft, const std::vector<uint32_t>& order, const std::vector<uint32_t>& segments) {
  Plan plan;
  for (const Graph::Entry& entry : draft.graph.nodes()) plan.nodeNames.push_back(entry.name);
  Layout layout(draft, plan);
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t node = order[i];
    const Declaration& declaration = draft.declarations[node];
    PlannedStep step;
    step.node = node;
    step.segment = segments[i];
    step.type = std::string(draft.graph.nodes()[node].node->type());
    step.hostPaced = declaration.isHostPaced();
    step.everyFrame = declaration.runsEveryFrame();
    step.counts = declaration.publishedCounts;
    for (uint32_t p = 0; p < declaration.ports.size(); ++p) {
      step.ports.push_back(layout.plan(node, p, static_cast<uint32_t>(i)));
      if (step.ports.back().resource == kNoResource) continue;
      for (std::string& count : shapeCounts(declaration.ports[p])) {
        if (std::find(step.neededCounts.begin(), step.neededCounts.end(), count) == step.neededCounts.end()) {
          step.neededCounts.push_back(std::move(count));
        }
      }
    }
    plan.steps.push_back(std::move(step));
  }
  plan.segmentCount = segments.empty() ? 0 : segments.back() + 1;
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    if (!draft.culled[n]) {
      if (!draft.declarations[n].advice().empty()) plan.advice.emplace_back(draft.nodeName(n), draft.declarations[n].advice());
      continue;
    }
    plan.culled.push_back({draft.nodeName(n), std::string(draft.graph.nodes()[n].node->type()), draft.culled[n]->reason});
  }
  return plan;
}

void alias(Plan& plan, const Counts& knownCounts) {
  struct Slot {
    ResourceKind kind;
    uint32_t segment;
    uint32_t freeFrom;  ///< first step at which its last member is dead
  };
  std::vector<Slot> slots;
  for (uint32_t i = 0; i < plan.steps.size(); ++i) {
    lend(plan, i);
    std::vector<ResourceId> scratch;
    for (const PlannedPort& port : plan.steps[i].ports) {
      if (port.access != Access::Scratch || port.resource == kNoResource) continue;
      if (plan.resources[port.resource].lender == kNoResource) scratch.push_back(port.resource);
    }
    // Largest first, so that the large ones of different nodes meet in one slot.
    std::stable_sort(scratch.begin(), scratch.end(), [&](ResourceId a, ResourceId b) {
      return guessBytes(plan.resources[a].shape, knownCounts) > guessBytes(plan.resources[b].shape, knownCounts);
    });
    for (const ResourceId id : scratch) {
      PlannedResource& resource = plan.resources[id];
      const auto fits = [&](const Slot& s) {
        return s.kind == resource.shape.kind && s.segment == plan.steps[i].segment && s.freeFrom <= resource.firstUse;
      };
      auto slot = std::find_if(slots.begin(), slots.end(), fits);
      if (slot == slots.end()) slot = slots.insert(slots.end(), {resource.shape.kind, plan.steps[i].segment, 0});
      slot->freeFrom = resource.lastUse + 1;
      resource.aliasSlot = static_cast<uint32_t>(slot - slots.begin());
    }
  }
}

void synchronize(Plan& plan) {
  struct State {
    uint32_t writeUse = 0;  ///< of the last write
    uint32_t readUse = 0;   ///< of the reads since
  };
  // Scratch in one slot is one piece of memory.
  std::map<std::pair<bool, uint32_t>, State> states;
  for (PlannedStep& step : plan.steps) {
    for (const PlannedPort& port : step.ports) {
      if (port.resource == kNoResource) continue;
      const PlannedResource& resource = plan.resources[port.resource];
      const bool inSlot = resource.aliasSlot != kNoSlot;
      const ResourceId memory = resource.lender != kNoResource ? resource.lender : port.resource;
      State& state = states[{inSlot, inSlot ? resource.aliasSlot : memory}];
      if (port.access == Access::Read) {
        if (state.writeUse != 0 && (state.readUse & port.use) != port.use) {
          step.barriers.push_back({port.resource, state.writeUse, port.use, true, false});
        }
        state.readUse |= port.use;
        continue;
      }
      if ((state.writeUse | state.readUse) != 0) {
        const bool written = state.writeUse != 0;
        step.barriers.push_back({port.resource, state.writeUse | state.readUse, port.use, written, true});
      }
      state = {port.use, 0};
    }
  }
}

}  // namespace detail

const PlannedPort* Plan::findPort(std::string_view node, std::string_view port) const {
  for (const PlannedStep& step : steps) {
    if (nodeNames[step.node] != node) continue;
    for (const PlannedPort& p : step.ports) {
      if (p.name == port) return &p;
    }
  }
  return nullptr;
}

}  // namespace radivox::graph
