// The user's graph: nodes, edges, outputs. Compiling never edits it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/graph/node.h"
#include "engine/plugin/registry.h"

namespace radivox::graph {

/// "node.port"
struct Endpoint {
  std::string node, port;
  std::string print() const { return node + "." + port; }
};

class Graph {
 public:
  struct Entry {
    std::string name;
    std::unique_ptr<Node> node;
  };
  struct Edge {
    Endpoint from, to;
  };

  /// Names are unique; throws BadInput otherwise.
  Node& add(std::string name, std::unique_ptr<Node> node);
  /// "voxelize.occupancy", "index.occupancy". `from` may also be the name of an import ("scene.vertices", "host.gbuffer_position"); the
  /// text up to the first dot is the node's name, the rest is the port's (port names may hold dots: "voxelize.scene.vertices").
  void connect(std::string_view from, std::string_view to);
  /// Removes the edge into `to`; none is fine.
  void disconnect(std::string_view to);
  void output(std::string_view endpoint);  ///< kept alive and readable after the run
  void clearOutputs() { outputs_.clear(); }
  /// What node `name` makes comes from the host: edges from "gbuffer.position" now come from the import "host.position" (with `import`
  /// "host"), and the node goes, with all that names it. Throws BadInput with the nearest name, and where an output is its port.
  void replaceByImports(std::string_view name, std::string_view import);
  /// What a picture of this graph can be asked for: AOV name → "node.port", or "node.port.w" for one channel (x, y, z, w) of an image.
  /// Only a table of names: nothing is kept alive by it (a host calls output() for the AOVs it wants).
  void setAov(std::string name, std::string endpoint) { aovs_[std::move(name)] = std::move(endpoint); }
  const std::map<std::string, std::string>& aovs() const { return aovs_; }

  Node* find(std::string_view name) const;
  /// `--set node.param=value`. Throws BadInput with the nearest name.
  params::Invalidates set(std::string_view nodeParam, std::string_view value);

  const std::vector<Entry>& nodes() const { return nodes_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Endpoint>& outputs() const { return outputs_; }

  /// {"nodes": {"voxelize": {"type": "clustered_voxel.voxelize", "params": {"resolution": 64}}, …},
  ///  "edges": [["voxelize.occupancy", "index.occupancy"], …], "outputs": ["composite.color"],
  ///  "aovs": {"color": "composite.color", "depth": "gbuffer.position.w"}, "help": "one line"}
  /// "aovs" and "help" may be missing; the node of an AOV must exist.
  /// `source` names the file in errors. All errors of a graph come in one message. Throws BadInput.
  static Graph fromJson(std::string_view text, const std::string& source, const plugin::Registry& registry);
  std::string toJson() const;
  /// {"name": "paper", "help": "…", "graph": "clustered_voxel", "request": {"bounces": 1}, "set": {"voxelize.resolution": 64, …}}.
  /// Applies "set" only; "name", "help", "graph" and "request" are the host's to read, any other key is an error. Parameters of nodes
  /// that the graph lacks are errors.
  void applyPreset(std::string_view text, const std::string& source);

 private:
  std::string describeUnknown(std::string_view name) const;
  std::vector<Entry> nodes_;
  std::vector<Edge> edges_;
  std::vector<Endpoint> outputs_;
  std::map<std::string, std::string> aovs_;
  std::string help_;  ///< of the file
};

}  // namespace radivox::graph
