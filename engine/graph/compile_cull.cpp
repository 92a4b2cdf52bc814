// What is left out, and why.
#include <algorithm>

#include "engine/graph/compile.h"

namespace radivox::graph::detail {
namespace {

bool takesPart(const Port& port) { return !isInput(port) || !port.unwanted; }

/// Leaves out nodes that need something left out, until nothing changes.
void propagateLeftOut(Draft& draft) {
  const auto need = [&](uint32_t node, const std::string& what, uint32_t producer) {
    const std::string& root = draft.culled[producer]->root;
    draft.culled[node] = Culled{"needs " + what + ", which was left out: " + root, root};
  };
  bool changed = true;
  while (changed) {
    changed = false;
    for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
      const auto& ports = draft.declarations[n].ports;
      for (uint32_t p = 0; p < ports.size() && draft.isLive(n); ++p) {
        if (ports[p].optional || !takesPart(ports[p])) continue;
        const Source& source = draft.sources[n][p];
        if (source.node != kNone && !draft.isLive(source.node)) {
          need(n, draft.sourceName(source), source.node);
          changed = true;
          break;
        }
        for (const std::string& count : shapeCounts(ports[p])) {
          const uint32_t publisher = draft.publisher(count);
          if (publisher == kNone || draft.isLive(publisher)) continue;
          need(n, "the count " + count + " of " + draft.nodeName(publisher), publisher);
          changed = true;
          break;
        }
      }
    }
  }
}

/// Walks from the outputs to what they need.
class Liveness {
 public:
  explicit Liveness(Draft& draft) : draft_(draft), live(draft.declarations.size(), 0) {}

  void wantPort(uint32_t node, uint32_t port) {
    draft_.wanted[node][port] = 1;
    wantNode(node);
    wantCounts(node, port);
  }

  void wantNode(uint32_t node) {
    if (live[node] != 0 || !draft_.isLive(node)) return;
    live[node] = 1;
    const auto& ports = draft_.declarations[node].ports;
    for (uint32_t p = 0; p < ports.size(); ++p) {
      if (isInput(ports[p])) {
        if (draft_.reads(node, p) && draft_.sources[node][p].node != kNone)
          wantPort(draft_.sources[node][p].node, draft_.sources[node][p].port);
      } else if (!ports[p].optional || draft_.wanted[node][p] != 0) {
        wantCounts(node, p);
      }
    }
  }

 private:
  void wantCounts(uint32_t node, uint32_t port) {
    for (const std::string& count : shapeCounts(draft_.declarations[node].ports[port])) {
      const uint32_t publisher = draft_.publisher(count);
      if (publisher != kNone && publisher != node) wantNode(publisher);
    }
  }

  Draft& draft_;

 public:
  std::vector<char> live;
};

/// "no reader of a.x, a.y; b does not want a.x: reason; c was left out".
Culled explainUnread(const Draft& draft, uint32_t node) {
  const auto& ports = draft.declarations[node].ports;
  std::string unread, all;
  std::string details;
  std::string root;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    if (!isOutput(ports[p]) && ports[p].access != Access::ReadBack) continue;
    bool explained = false;
    for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
      for (uint32_t q = 0; q < draft.declarations[n].ports.size(); ++q) {
        const Source& source = draft.sources[n][q];
        if (source.node != node || source.port != p) continue;
        explained = true;
        std::string detail;
        if (draft.declarations[n].ports[q].unwanted) {
          const std::string& why = draft.declarations[n].ports[q].unwantedReason;
          detail = "; " + draft.nodeName(n) + " does not want " + draft.portName(node, p) + (why.empty() ? "" : ": " + why);
          if (root.empty()) root = why;
        } else {
          detail = "; " + draft.nodeName(n) + " was left out";
          if (root.empty() && draft.culled[n]) root = draft.culled[n]->root;
        }
        if (details.find(detail) == std::string::npos) details += detail;
      }
    }
    if (explained || !ports[p].optional) unread += (unread.empty() ? "" : ", ") + draft.portName(node, p);
    all += (all.empty() ? "" : ", ") + draft.portName(node, p);
  }
  if (unread.empty()) unread = all;
  const std::string reason = "no reader of " + unread + details;
  return {reason, root.empty() ? reason : root};
}

bool hasOutput(const Declaration& declaration) {
  return std::any_of(declaration.ports.begin(), declaration.ports.end(),
                     [](const Port& p) { return isOutput(p) || p.access == Access::ReadBack; });
}

}  // namespace

void cull(Draft& draft) {
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    const std::string& reason = draft.declarations[n].leftOut();
    if (!reason.empty()) draft.culled[n] = Culled{reason, reason};
  }
  propagateLeftOut(draft);

  Liveness liveness(draft);
  for (const Endpoint& output : draft.graph.outputs()) {
    for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
      if (draft.nodeName(n) != output.node || !draft.isLive(n)) continue;
      for (uint32_t p = 0; p < draft.declarations[n].ports.size(); ++p) {
        if (draft.declarations[n].ports[p].name == output.port) liveness.wantPort(n, p);
      }
    }
  }
  const bool keepsUnread = draft.input.traits.keeps(scene::Feature::Readers);
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    if (keepsUnread || !hasOutput(draft.declarations[n])) liveness.wantNode(n);
    for (uint32_t p = 0; keepsUnread && draft.isLive(n) && p < draft.declarations[n].ports.size(); ++p) {
      if (isOutput(draft.declarations[n].ports[p])) liveness.wantPort(n, p);
    }
  }
  // Consumers first, so that a producer can print why its readers went: repeat until every reason has its root.
  std::vector<uint32_t> dead;
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    if (draft.isLive(n) && liveness.live[n] == 0) dead.push_back(n);
  }
  for (size_t round = 0; round <= dead.size(); ++round) {
    bool changed = false;
    for (const uint32_t n : dead) {
      Culled culled = explainUnread(draft, n);
      if (!draft.culled[n] || draft.culled[n]->reason != culled.reason || draft.culled[n]->root != culled.root) {
        draft.culled[n] = std::move(culled);
        changed = true;
      }
    }
    if (!changed) break;
  }
}

void settleFrees(Draft& draft) {
  const auto comeBefore = [&](uint32_t node) {
    std::vector<char> before(draft.declarations.size(), 0);
    std::vector<uint32_t> open{node};
    while (!open.empty()) {
      const uint32_t next = open.back();
      open.pop_back();
      for (const uint32_t p : predecessors(draft, next)) {
        if (before[p] == 0) open.push_back(p);
        before[p] = 1;
      }
    }
    return before;
  };
  const auto isLastReader = [&](uint32_t n, uint32_t p) {
    const Source& source = draft.sources[n][p];
    if (source.node == kNone) return false;  // the host's own
    const std::string name = draft.sourceName(source);
    const std::vector<Endpoint>& outputs = draft.graph.outputs();
    if (std::any_of(outputs.begin(), outputs.end(), [&](const Endpoint& output) { return output.print() == name; })) return false;
    const std::vector<char> before = comeBefore(n);
    for (uint32_t m = 0; m < draft.declarations.size(); ++m) {
      for (uint32_t q = 0; q < draft.declarations[m].ports.size(); ++q) {
        const bool isOther = m != n || q != p;
        if (!isOther || !draft.isLive(m) || !draft.reads(m, q) || !isSame(source, draft.sources[m][q])) continue;
        if (m == n || before[m] == 0 || draft.declarations[m].ports[q].access != Access::Read) return false;
      }
    }
    return true;
  };
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    for (uint32_t p = 0; p < draft.declarations[n].ports.size(); ++p) {
      Port& port = draft.declarations[n].ports[p];
      if (!port.frees) continue;
      port.frees = !draft.input.keepsAll && draft.isLive(n) && draft.reads(n, p) && isLastReader(n, p);
      if (port.frees) port.access = Access::Modify;
    }
  }
}

}  // namespace radivox::graph::detail
