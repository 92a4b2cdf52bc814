#include "modules/vdb/wiring.h"

#include <algorithm>

#include "engine/plugin/registry.h"

namespace radivox::vdb {

namespace {

const graph::Graph::Entry* findType(const graph::Graph& graph, std::string_view type) {
  const auto found = std::find_if(graph.nodes().begin(), graph.nodes().end(), [&](const auto& e) { return e.node->type() == type; });
  return found == graph.nodes().end() ? nullptr : &*found;
}

/// clustered_voxel.fragments is for inspection alone, so graphs seldom have it.
void addFragments(graph::Graph& graph, const plugin::Registry& registry) {
  constexpr const char* kType = "clustered_voxel.fragments";
  const graph::Graph::Entry* voxelize = findType(graph, "clustered_voxel.voxelize");
  const graph::Graph::Entry* index = findType(graph, "clustered_voxel.index");
  if (findType(graph, kType) != nullptr || voxelize == nullptr || index == nullptr) return;
  const std::string grid = voxelize->name + ".grid", occupancy = voxelize->name + ".occupancy", rank = index->name + ".rank";
  std::string name = "fragments";
  while (graph.find(name) != nullptr) name += "_";
  graph.add(name, registry.make(kType));
  graph.connect(grid, name + ".grid");
  graph.connect(occupancy, name + ".occupancy");
  graph.connect(rank, name + ".rank");
}

}  // namespace

std::string findSource(const graph::Graph& graph, const Input& input) {
  const graph::Graph::Entry* entry = findType(graph, input.nodeType);
  return entry == nullptr ? "" : entry->name + "." + input.from;
}

std::vector<std::string> connectSink(graph::Graph& graph, const std::string& sink, const std::vector<GridName>& grids,
                                     const plugin::Registry& registry) {
  const uint32_t needs = needsOf(grids);
  if ((needs & (NeedFragments | NeedNormals)) != 0) addFragments(graph, registry);
  for (const Input& input : inputs()) {
    const std::string from = findSource(graph, input);
    if ((input.need == 0 || (input.need & needs) != 0) && !from.empty()) graph.connect(from, sink + "." + input.port);
  }
  std::vector<std::string> missing;
  for (const GridName& grid : grids) {
    for (const Input& input : inputs()) {
      if (input.need != 0 && (input.need & grid.needs()) == 0) continue;
      if (!findSource(graph, input).empty()) continue;
      missing.push_back(grid.print() + ": " + input.nodeType);
      break;
    }
  }
  return missing;
}

void leaveOutRays(graph::Graph& graph, const std::vector<GridName>& grids) {
  if ((needsOf(grids) & (NeedRows | NeedIndirect | NeedError)) != 0) return;
  // What inject takes from visibility it has elsewhere: masks, and clusters whose means go by area, which no grid shows.
  const graph::Graph::Entry* inject = findType(graph, "clustered_voxel.inject");
  const graph::Graph::Entry* faces = findType(graph, "clustered_voxel.faces");
  const graph::Graph::Entry* members = findType(graph, "clustered_voxel.members");
  if (inject == nullptr || faces == nullptr || members == nullptr) return;
  for (const auto& [from, to] :
       {std::pair(std::string(), "planes"), std::pair(faces->name + ".mask", "mask"), std::pair(members->name + ".members", "members")}) {
    graph.disconnect(inject->name + "." + to);
    if (!from.empty()) graph.connect(from, inject->name + "." + to);
  }
}

}  // namespace radivox::vdb
