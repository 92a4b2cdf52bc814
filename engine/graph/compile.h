// The steps of compile(), each a function over plain data. Private to engine/graph and its tests.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/graph/plan.h"

namespace radivox::graph::detail {

constexpr uint32_t kNone = 0xffffffffu;

/// Where a Read or Modify port gets its resource from.
struct Source {
  uint32_t node = kNone;              ///< producing node
  uint32_t port = kNone;              ///< its port; kNone with a node: the node is left out and did not declare it
  uint32_t importIndex = kNone;       ///< or the import
  const Graph::Edge* edge = nullptr;  ///< null where a port binds itself to an import
  bool broken = false;                ///< its edge is in error already: not to be called unconnected as well
  bool isConnected() const { return node != kNone || importIndex != kNone; }
};

/// Whatever edge each came by.
inline bool isSame(const Source& a, const Source& b) { return a.node == b.node && a.port == b.port && a.importIndex == b.importIndex; }

/// Why a node is not in the plan. `root` is what the nodes that need it print.
struct Culled {
  std::string reason;
  std::string root;
};

struct Draft {
  const Graph& graph;
  const CompileInput& input;
  std::vector<Declaration> declarations;      // per node
  std::vector<std::vector<Source>> sources;   // per node and port
  std::vector<std::vector<char>> wanted;      // per node and port: somebody live reads it or it is an output
  std::vector<std::optional<Culled>> culled;  // per node
  std::vector<std::string> errors;

  const std::string& nodeName(uint32_t node) const { return graph.nodes()[node].name; }
  std::string portName(uint32_t node, uint32_t port) const { return nodeName(node) + "." + declarations[node].ports[port].name; }
  bool isLive(uint32_t node) const { return !culled[node]; }
  /// The port is in the plan: optional outputs only when wanted.
  bool exists(uint32_t node, uint32_t port) const;
  /// The input takes part: connected, wanted, and its producer is in the plan.
  bool reads(uint32_t node, uint32_t port) const;
  /// The node that publishes `count`, or kNone.
  uint32_t publisher(const std::string& count) const;
  std::string sourceName(const Source& source) const;
};

inline bool isInput(const Port& port) { return port.access == Access::Read || port.access == Access::Modify; }
inline bool isOutput(const Port& port) { return port.access == Access::Write || port.access == Access::Modify; }
/// Counts in a port's shape (none for ports that take the producer's).
std::vector<std::string> shapeCounts(const Port& port);

/// Calls declare on every node.
Draft declareAll(const Graph& graph, const CompileInput& input);
/// Resolves edges and imports; unknown names, wrong directions, second producers.
void connectPorts(Draft& draft);
/// Leaves out what declared itself out, what needs it, and what nobody reads; marks wanted ports.
void cull(Draft& draft);
/// Ports that free what they read (Port::frees) modify it where all its other readers come before them; elsewhere they are plain readers.
void settleFrees(Draft& draft);
/// Errors that only concern live nodes: missing inputs, kinds, dead versions, counts that nobody publishes, cycles.
void checkLive(Draft& draft);
/// Stable topological order of the live nodes: the earliest added node that is ready goes first.
std::vector<uint32_t> order(const Draft& draft);
/// Segment of each step of `order`.
std::vector<uint32_t> segments(const Draft& draft, const std::vector<uint32_t>& order);
/// Steps and resources with version chains and lifetimes.
Plan layOut(const Draft& draft, const std::vector<uint32_t>& order, const std::vector<uint32_t>& segments);
/// Gives each scratch resource an alias slot.
void alias(Plan& plan, const Counts& knownCounts);
/// Barriers as if every step ran.
void synchronize(Plan& plan);

/// Nodes that must come before `node`: producers of its inputs and publishers of its counts. Ascending, each once.
std::vector<uint32_t> predecessors(const Draft& draft, uint32_t node);

}  // namespace radivox::graph::detail
