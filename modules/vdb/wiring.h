// Joins the sink vdb.write to a graph of clustered voxels.
#pragma once

#include <string>
#include <vector>

#include "engine/graph/graph.h"
#include "modules/vdb/catalogue.h"

namespace radivox::vdb {

/// The "node.port" that input `port` of vdb.write is fed from: the first node of its type. Empty where the graph has none.
std::string findSource(const graph::Graph& graph, const Input& input);

/// Connects the inputs that `grids` need of node `sink` (a vdb.write, already in the graph) by the types of the nodes that make them, and
/// adds what inspection alone needs (clustered_voxel.fragments). Returns the grids that the graph cannot make, each with the node type that
/// is missing: "indirect: clustered_voxel.gather".
std::vector<std::string> connectSink(graph::Graph& graph, const std::string& sink, const std::vector<GridName>& grids,
                                     const plugin::Registry& registry);

/// For a graph that is run for these grids alone: where none of them needs rays, direct light is injected without the ray-counted weights
/// of clusters, which no grid of direct light holds, and no ray is traced.
void leaveOutRays(graph::Graph& graph, const std::vector<GridName>& grids);

}  // namespace radivox::vdb
