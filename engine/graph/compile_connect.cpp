// Edges and imports: names to ports.
#include <algorithm>

#include "engine/graph/compile.h"

namespace radivox::graph::detail {
namespace {

std::string suggest(const std::string& name, const std::vector<std::string>& names) {
  const std::string near = params::nearestName(name, names);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

std::vector<std::string> nodeNames(const Draft& draft) {
  std::vector<std::string> names;
  for (const auto& entry : draft.graph.nodes()) names.push_back(entry.name);
  return names;
}

uint32_t findNode(const Draft& draft, const std::string& name) {
  for (uint32_t n = 0; n < draft.graph.nodes().size(); ++n) {
    if (draft.graph.nodes()[n].name == name) return n;
  }
  return kNone;
}

uint32_t findPort(const Draft& draft, uint32_t node, const std::string& name) {
  const auto& ports = draft.declarations[node].ports;
  for (uint32_t p = 0; p < ports.size(); ++p) {
    if (ports[p].name == name) return p;
  }
  return kNone;
}

uint32_t findImport(const Draft& draft, const std::string& name) {
  for (uint32_t i = 0; i < draft.input.imports.size(); ++i) {
    if (draft.input.imports[i].name == name) return i;
  }
  return kNone;
}

/// The port, or kNone with an error. A node that left itself out may have declared nothing: no error then.
uint32_t requirePort(Draft& draft, uint32_t node, const Endpoint& endpoint, const std::string& place, bool (*fits)(const Port&)) {
  const uint32_t port = findPort(draft, node, endpoint.port);
  if (port != kNone || !draft.declarations[node].leftOut().empty()) return port;
  std::vector<std::string> names;
  for (const Port& p : draft.declarations[node].ports) {
    if (fits(p)) names.push_back(p.name);
  }
  std::string error = place + ": " + endpoint.node + " has no port " + endpoint.port + suggest(endpoint.port, names);
  if (params::nearestName(endpoint.port, names).empty() && !names.empty()) {
    error += "; it has";
    for (size_t i = 0; i < names.size(); ++i) error += (i == 0 ? " " : ", ") + names[i];
  }
  draft.errors.push_back(error);
  return kNone;
}

const char* accessName(Access access) {
  switch (access) {
    case Access::Read:
      return "an input";
    case Access::Write:
      return "an output";
    case Access::Modify:
      return "input and output";
    case Access::Scratch:
      return "scratch memory, private to its node";
    case Access::ReadBack:
      return "host memory, read by the host only";
  }
  return "";
}

/// True when the edge is sound (or ends at a node that left itself out).
bool connectEdge(Draft& draft, const Graph::Edge& edge) {
  const std::string place = "edge " + edge.from.print() + " → " + edge.to.print();
  Source source;
  source.edge = &edge;
  const uint32_t fromNode = findNode(draft, edge.from.node);
  const uint32_t import = findImport(draft, edge.from.print());
  if (fromNode != kNone && import != kNone) {
    draft.errors.push_back(place + ": " + edge.from.node + " is a node and " + edge.from.print() + " an import; rename the node");
    return false;
  }
  if (fromNode != kNone) {
    source.node = fromNode;
    source.port = requirePort(draft, fromNode, edge.from, place, isOutput);
    if (source.port == kNone && draft.declarations[fromNode].leftOut().empty()) return false;
    if (source.port != kNone && !isOutput(draft.declarations[fromNode].ports[source.port])) {
      draft.errors.push_back(place + ": " + edge.from.print() + " is " +
                             accessName(draft.declarations[fromNode].ports[source.port].access) + "; an edge starts at an output");
      return false;
    }
  } else if (import != kNone) {
    source.importIndex = import;
  } else {
    std::vector<std::string> names = nodeNames(draft);
    std::vector<std::string> imports;
    for (const Import& i : draft.input.imports) imports.push_back(i.name);
    std::string hint = suggest(edge.from.print(), imports);
    if (hint.empty()) hint = suggest(edge.from.node, names);
    draft.errors.push_back(place + ": no node is named " + edge.from.node + ", no import " + edge.from.print() + hint);
    return false;
  }
  const uint32_t toNode = findNode(draft, edge.to.node);
  if (toNode == kNone) {
    draft.errors.push_back(place + ": no node is named " + edge.to.node + suggest(edge.to.node, nodeNames(draft)));
    return false;
  }
  const uint32_t toPort = requirePort(draft, toNode, edge.to, place, isInput);
  if (toPort == kNone) return true;
  const Port& port = draft.declarations[toNode].ports[toPort];
  if (!isInput(port)) {
    draft.errors.push_back(place + ": " + edge.to.print() + " is " + accessName(port.access) + "; an edge ends at an input");
    return false;
  }
  Source& taken = draft.sources[toNode][toPort];
  if (taken.isConnected()) {
    draft.errors.push_back(edge.to.print() + " has two producers: " + draft.sourceName(taken) + " and " + edge.from.print() +
                           "; remove one edge");
    return false;
  }
  taken = source;
  return true;
}

bool bindsItself(const std::string& port) { return port.rfind("scene.", 0) == 0 || port.rfind("view.", 0) == 0; }

}  // namespace

void connectPorts(Draft& draft) {
  for (const Graph::Edge& edge : draft.graph.edges()) {
    if (connectEdge(draft, edge)) continue;
    const uint32_t node = findNode(draft, edge.to.node);
    const uint32_t port = node == kNone ? kNone : findPort(draft, node, edge.to.port);
    if (port != kNone) draft.sources[node][port].broken = true;
  }
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    for (uint32_t p = 0; p < draft.declarations[n].ports.size(); ++p) {
      const Port& port = draft.declarations[n].ports[p];
      Source& source = draft.sources[n][p];
      if (isInput(port) && !source.isConnected() && bindsItself(port.name)) source.importIndex = findImport(draft, port.name);
    }
  }
  for (const Endpoint& output : draft.graph.outputs()) {
    const std::string place = "output " + output.print();
    const uint32_t node = findNode(draft, output.node);
    if (node == kNone) {
      draft.errors.push_back(place + ": no node is named " + output.node + suggest(output.node, nodeNames(draft)));
      continue;
    }
    const uint32_t port = requirePort(draft, node, output, place, isOutput);
    if (port == kNone) continue;
    const Access access = draft.declarations[node].ports[port].access;
    if (access == Access::Read || access == Access::Scratch) {
      draft.errors.push_back(place + ": it is " + accessName(access));
    }
  }
}

}  // namespace radivox::graph::detail
