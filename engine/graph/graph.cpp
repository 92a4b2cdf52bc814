#include "engine/graph/graph.h"

#include <algorithm>

#include "engine/error.h"

namespace radivox::graph {
namespace {

Endpoint parseEndpoint(std::string_view text) {
  const size_t dot = text.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size()) {
    throw Error(ErrorCode::BadInput, "\"" + std::string(text) + "\" is no endpoint; write node.port");
  }
  return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

}  // namespace

Node& Graph::add(std::string name, std::unique_ptr<Node> node) {
  if (name.empty() || name.find('.') != std::string::npos) {
    throw Error(ErrorCode::BadInput, "\"" + name + "\" cannot name a node; use a name without dots");
  }
  if (find(name) != nullptr) throw Error(ErrorCode::BadInput, "two nodes are named " + name + "; rename one");
  nodes_.push_back({std::move(name), std::move(node)});
  return *nodes_.back().node;
}

void Graph::connect(std::string_view from, std::string_view to) { edges_.push_back({parseEndpoint(from), parseEndpoint(to)}); }

void Graph::disconnect(std::string_view to) {
  const Endpoint endpoint = parseEndpoint(to);
  std::erase_if(edges_, [&](const Edge& edge) { return edge.to.node == endpoint.node && edge.to.port == endpoint.port; });
}

void Graph::output(std::string_view endpoint) {
  Endpoint parsed = parseEndpoint(endpoint);
  const auto same = [&](const Endpoint& o) { return o.node == parsed.node && o.port == parsed.port; };
  if (std::none_of(outputs_.begin(), outputs_.end(), same)) outputs_.push_back(std::move(parsed));
}

Node* Graph::find(std::string_view name) const {
  for (const Entry& entry : nodes_) {
    if (entry.name == name) return entry.node.get();
  }
  return nullptr;
}

void Graph::replaceByImports(std::string_view name, std::string_view import) {
  if (find(name) == nullptr) throw Error(ErrorCode::BadInput, describeUnknown(name));
  if (import.empty() || import.find('.') != std::string_view::npos || find(import) != nullptr) {
    throw Error(ErrorCode::BadInput,
                "\"" + std::string(import) + "\" cannot stand for " + std::string(name) + "; use a name without dots that no node has");
  }
  for (const Endpoint& output : outputs_) {
    if (output.node == name) {
      throw Error(ErrorCode::BadInput, output.print() + " is an output of the graph; the host has it already: leave it out");
    }
  }
  const auto isOf = [&](const Endpoint& endpoint) { return endpoint.node == name; };
  std::erase_if(edges_, [&](const Edge& edge) { return isOf(edge.to); });
  for (Edge& edge : edges_) {
    if (isOf(edge.from)) edge.from.node = import;
  }
  std::erase_if(aovs_, [&](const auto& aov) { return isOf(parseEndpoint(aov.second)); });
  std::erase_if(nodes_, [&](const Entry& entry) { return entry.name == name; });
}

std::string Graph::describeUnknown(std::string_view name) const {
  std::vector<std::string> names;
  for (const Entry& entry : nodes_) names.push_back(entry.name);
  const std::string near = params::nearestName(name, names);
  return "no node is named " + std::string(name) + (near.empty() ? "; see `radivox graph` for the nodes" : "; did you mean " + near + "?");
}

params::Invalidates Graph::set(std::string_view nodeParam, std::string_view value) {
  const size_t dot = nodeParam.find('.');
  if (dot == std::string_view::npos) {
    throw Error(ErrorCode::BadInput, "\"" + std::string(nodeParam) + "\" names no parameter; write node.param=value");
  }
  const std::string_view name = nodeParam.substr(0, dot);
  Node* node = find(name);
  if (node == nullptr) throw Error(ErrorCode::BadInput, std::string(nodeParam) + ": " + describeUnknown(name));
  return node->params().set(name, nodeParam.substr(dot + 1), value);
}

}  // namespace radivox::graph
