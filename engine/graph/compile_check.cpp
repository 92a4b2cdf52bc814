// Errors of live nodes: missing inputs, kinds, dead versions, unknown counts, cycles.
#include <algorithm>

#include "engine/graph/compile.h"

namespace radivox::graph::detail {
namespace {

void checkInputs(Draft& draft, uint32_t node) {
  const auto& ports = draft.declarations[node].ports;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    const Port& port = ports[p];
    const Source& source = draft.sources[node][p];
    if (!isInput(port) || port.optional || port.unwanted || source.isConnected() || source.broken) continue;
    std::string error = draft.portName(node, p) + " is not connected";
    if (port.name.rfind("scene.", 0) == 0 || port.name.rfind("view.", 0) == 0) {
      if (!draft.isLive(node)) continue;  // a host need not import what nobody reads
      std::vector<std::string> imports;
      for (const Import& i : draft.input.imports) imports.push_back(i.name);
      const std::string near = params::nearestName(port.name, imports);
      error = draft.portName(node, p) + " needs the import " + port.name + ", which the host does not give";
      if (!near.empty()) error += "; it gives " + near;
    }
    draft.errors.push_back(error);
  }
}

/// Shape, kind and growth of what comes in; follows Modify ports up to the first writer.
struct Origin {
  ResourceKind kind = ResourceKind::Buffer;
  bool growable = false;
};

Origin originOf(const Draft& draft, Source source) {
  // A chain is at most as long as there are nodes; more would be a cycle, which has its own error.
  for (size_t hops = 0; hops <= draft.declarations.size() && source.node != kNone && source.port != kNone; ++hops) {
    const Port& port = draft.declarations[source.node].ports[source.port];
    if (port.access != Access::Modify) return {port.shape.kind, port.growable};
    source = draft.sources[source.node][source.port];
  }
  if (source.importIndex != kNone) return {draft.input.imports[source.importIndex].shape.kind, false};
  return {};
}

const char* kindName(ResourceKind kind) { return kind == ResourceKind::Buffer ? "a buffer" : "an image"; }

void checkKinds(Draft& draft, uint32_t node) {
  const auto& ports = draft.declarations[node].ports;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    if (!isInput(ports[p]) || !draft.reads(node, p)) continue;
    const Origin origin = originOf(draft, draft.sources[node][p]);
    std::optional<ResourceKind> expected = ports[p].kind;
    if (!expected && (ports[p].use & UseAttachment) != 0) expected = ResourceKind::Image;
    if (!expected && (ports[p].use & UseIndirect) != 0) expected = ResourceKind::Buffer;
    if (expected && *expected != origin.kind) {
      draft.errors.push_back(draft.portName(node, p) + " takes " + kindName(*expected) + ", " + draft.sourceName(draft.sources[node][p]) +
                             " is " + kindName(origin.kind));
    }
  }
}

void checkCounts(Draft& draft, uint32_t node) {
  const auto& ports = draft.declarations[node].ports;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    if (!draft.exists(node, p)) continue;
    for (const std::string& count : shapeCounts(ports[p])) {
      const uint32_t publisher = draft.publisher(count);
      if (publisher == kNone && draft.input.knownCounts.count(count) != 0) continue;
      if (publisher == node) {
        draft.errors.push_back(draft.portName(node, p) + " is shaped by the count " + count + ", which its own node publishes");
      } else if (publisher == kNone) {
        std::vector<std::string> names;
        for (const auto& known : draft.input.knownCounts) names.push_back(known.first);
        for (const Declaration& d : draft.declarations) {
          for (const auto& published : d.publishedCounts) names.push_back(published.name);
        }
        const std::string near = params::nearestName(count, names);
        draft.errors.push_back(draft.portName(node, p) + " is shaped by the count " + count + ", which nobody publishes" +
                               (near.empty() ? "" : "; did you mean " + near + "?"));
      } else if (!draft.isLive(publisher)) {
        draft.errors.push_back(draft.portName(node, p) + " is shaped by the count " + count + " of " + draft.nodeName(publisher) +
                               ", which was left out: " + draft.culled[publisher]->root);
      }
    }
  }
}

/// A version that a Modify port continues is dead: nobody else may read it, or the order would decide what they see. (Of what is freed the other
/// readers come before by their edges: settleFrees.)
void checkDeadVersions(Draft& draft) {
  struct Reader {
    uint32_t node, port;
  };
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    for (uint32_t p = 0; p < draft.declarations[n].ports.size(); ++p) {
      const Port& port = draft.declarations[n].ports[p];
      if (port.access != Access::Modify || port.frees || !draft.isLive(n) || !draft.reads(n, p)) continue;
      const Source& killed = draft.sources[n][p];
      const std::string name = draft.sourceName(killed);
      for (uint32_t m = 0; m < draft.declarations.size(); ++m) {
        for (uint32_t q = 0; q < draft.declarations[m].ports.size(); ++q) {
          if ((m == n && q == p) || !draft.isLive(m) || !draft.reads(m, q) || !isSame(killed, draft.sources[m][q])) continue;
          const bool both = draft.declarations[m].ports[q].access == Access::Modify;
          if (both && (m < n || (m == n && q < p))) continue;  // said once
          draft.errors.push_back(both ? draft.portName(n, p) + " and " + draft.portName(m, q) + " both modify " + name +
                                            "; chain them: one takes what the other gives"
                                      : draft.portName(m, q) + " reads " + name + ", a version that " + draft.nodeName(n) +
                                            " modifies; read " + draft.portName(n, p) + " instead");
        }
      }
      for (const Endpoint& output : draft.graph.outputs()) {
        if (output.print() == name) {
          draft.errors.push_back("output " + name + " is a version that " + draft.nodeName(n) + " modifies; output " +
                                 draft.portName(n, p) + " instead");
        }
      }
    }
  }
}

/// Depth first; the first cycle met is printed as the path that closes it.
class CycleFinder {
 public:
  explicit CycleFinder(Draft& draft) : draft_(draft), state_(draft.declarations.size(), 0) {}

  void run() {
    for (uint32_t n = 0; n < state_.size(); ++n) {
      if (state_[n] == 0) visit(n);
    }
  }

 private:
  void visit(uint32_t node) {
    state_[node] = 1;
    path_.push_back(node);
    for (const uint32_t before : predecessors(draft_, node)) {
      if (state_[before] == 0) {
        visit(before);
      } else if (state_[before] == 1) {
        report(before);
      }
    }
    path_.pop_back();
    state_[node] = 2;
  }

  void report(uint32_t start) {
    // The path runs from consumer to producer; data flows the other way.
    const auto first = std::find(path_.begin(), path_.end(), start);
    std::string text = "cycle: " + draft_.nodeName(start);
    for (auto node = path_.end(); node != first;) text += " → " + draft_.nodeName(*--node);
    draft_.errors.push_back(text + "; remove one of these edges");
  }

  Draft& draft_;
  std::vector<char> state_;  // 0 not seen, 1 on the path, 2 done
  std::vector<uint32_t> path_;
};

}  // namespace

std::vector<uint32_t> predecessors(const Draft& draft, uint32_t node) {
  std::vector<uint32_t> before;
  if (!draft.isLive(node)) return before;
  const auto& ports = draft.declarations[node].ports;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    if (isInput(ports[p])) {
      if (draft.reads(node, p) && draft.sources[node][p].node != kNone) before.push_back(draft.sources[node][p].node);
      continue;
    }
    if (!draft.exists(node, p)) continue;
    for (const std::string& count : shapeCounts(ports[p])) {
      const uint32_t publisher = draft.publisher(count);
      if (publisher != kNone && publisher != node && draft.isLive(publisher)) before.push_back(publisher);
    }
  }
  std::sort(before.begin(), before.end());
  before.erase(std::unique(before.begin(), before.end()), before.end());
  return before;
}

void checkLive(Draft& draft) {
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    // An unconnected input is an error of the graph even where nobody needs the node now; a node that left itself out may miss any.
    if (!draft.declarations[n].leftOut().empty()) continue;
    checkInputs(draft, n);
    checkKinds(draft, n);
    if (draft.isLive(n)) checkCounts(draft, n);
  }
  checkDeadVersions(draft);
  CycleFinder(draft).run();
}

}  // namespace radivox::graph::detail
