#include "engine/graph/compile.h"

#include <algorithm>

#include "engine/error.h"

namespace radivox::graph {

Plan compile(const Graph& graph, const CompileInput& input) {
  detail::Draft draft = detail::declareAll(graph, input);
  detail::connectPorts(draft);
  detail::cull(draft);
  detail::settleFrees(draft);
  detail::checkLive(draft);
  if (!draft.errors.empty()) {
    std::string message = draft.errors.front();
    for (size_t i = 1; i < draft.errors.size(); ++i) message += "; " + draft.errors[i];
    throw Error(ErrorCode::BadInput, "graph: " + message);
  }
  const std::vector<uint32_t> order = detail::order(draft);
  Plan plan = detail::layOut(draft, order, detail::segments(draft, order));
  detail::alias(plan, input.knownCounts);
  detail::synchronize(plan);
  return plan;
}

namespace detail {

bool Draft::exists(uint32_t node, uint32_t port) const {
  const Port& p = declarations[node].ports[port];
  return isLive(node) && (!p.optional || p.access == Access::Read || p.access == Access::Modify || wanted[node][port] != 0);
}

bool Draft::reads(uint32_t node, uint32_t port) const {
  const Source& source = sources[node][port];
  if (declarations[node].ports[port].unwanted || !source.isConnected()) return false;
  return source.node == kNone || (source.port != kNone && isLive(source.node));
}

uint32_t Draft::publisher(const std::string& count) const {
  for (uint32_t n = 0; n < declarations.size(); ++n) {
    for (const auto& published : declarations[n].publishedCounts) {
      if (published.name == count) return n;
    }
  }
  return kNone;
}

std::string Draft::sourceName(const Source& source) const {
  if (source.node == kNone) return input.imports[source.importIndex].name;
  return source.port == kNone ? source.edge->from.print() : portName(source.node, source.port);
}

std::vector<std::string> shapeCounts(const Port& port) {
  std::vector<std::string> names;
  if (isInput(port) || port.growable) return names;
  const auto append = [&](const Extent& extent) { names.insert(names.end(), extent.counts().begin(), extent.counts().end()); };
  if (port.shape.kind == ResourceKind::Buffer) {
    append(port.shape.elements);
  } else {
    append(port.shape.width);
    append(port.shape.height);
    append(port.shape.layers);
  }
  return names;
}

Draft declareAll(const Graph& graph, const CompileInput& input) {
  Draft draft{graph, input, {}, {}, {}, {}, {}};
  draft.declarations.reserve(graph.nodes().size());
  for (const Graph::Entry& entry : graph.nodes()) {
    Declaration& declaration = draft.declarations.emplace_back(input.traits, input.request, input.capabilities);
    entry.node->declare(declaration);
    draft.sources.emplace_back(declaration.ports.size());
    draft.wanted.emplace_back(declaration.ports.size(), 0);
    std::vector<std::string> seen;
    for (const Port& port : declaration.ports) {
      if (std::find(seen.begin(), seen.end(), port.name) != seen.end()) {
        draft.errors.push_back(entry.name + " declares the port " + port.name + " twice");
      }
      seen.push_back(port.name);
      if (port.growable && !declaration.isHostPaced()) {
        draft.errors.push_back(entry.name + "." + port.name + " is growable, but " + entry.name + " is not host-paced");
      }
      if (port.frees && (port.access != Access::Read || !declaration.isHostPaced())) {
        draft.errors.push_back(entry.name + "." + port.name + " frees what it reads, but is no input of a host-paced node");
      }
    }
    for (const auto& count : declaration.publishedCounts) {
      const auto port =
          std::find_if(declaration.ports.begin(), declaration.ports.end(), [&](const Port& p) { return p.name == count.port; });
      if (count.port.empty() ? !declaration.isHostPaced() : (port == declaration.ports.end() || !isOutput(*port))) {
        draft.errors.push_back(entry.name + " publishes the count " + count.name + " from \"" + count.port +
                               "\", which is no output of it");
      } else if (!count.port.empty()) {
        // A published word must be there to be read.
        draft.wanted.back()[static_cast<size_t>(port - declaration.ports.begin())] = 1;
      }
    }
  }
  draft.culled.resize(graph.nodes().size());
  for (uint32_t n = 0; n < draft.declarations.size(); ++n) {
    for (const auto& count : draft.declarations[n].publishedCounts) {
      const uint32_t first = draft.publisher(count.name);
      if (first != n)
        draft.errors.push_back("the count " + count.name + " is published by " + draft.nodeName(first) + " and " + draft.nodeName(n));
    }
  }
  return draft;
}

}  // namespace detail
}  // namespace radivox::graph
