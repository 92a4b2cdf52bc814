// compile: pure functions over plain data. validate → cull → order → segment → lifetimes → alias → sync. No GPU.
#pragma once

#include <string>
#include <vector>

#include "engine/graph/graph.h"

namespace radivox::graph {

using ResourceId = uint32_t;
constexpr ResourceId kNoResource = 0xffffffffu;
constexpr uint32_t kNoSlot = 0xffffffffu;

/// One version chain shares one resource: a Modify port continues its input's.
struct PlannedResource {
  std::string name;  ///< "node.port" of its first writer, or the import's name
  Shape shape;
  bool imported = false;
  bool persistent = false;
  bool growable = false;
  bool hostVisible = false;   ///< ReadBack
  std::string meaning;        ///< of its first writer's port
  uint32_t versionCount = 1;  ///< links of the version chain: 1, or 1 + the number of Modify ports
  bool scratch = false;
  bool output = false;
  uint32_t firstUse = 0;  ///< positions in Plan::steps, inclusive
  uint32_t lastUse = 0;
  /// Scratch resources with the same alias slot share memory (their lifetimes do not meet).
  uint32_t aliasSlot = kNoSlot;
  /// Scratch of one shape with a later output that must be written anew whenever this is: it is that output's memory, and has no slot.
  ResourceId lender = kNoResource;
};

struct PlannedPort {
  std::string name;
  ResourceId resource = kNoResource;  ///< kNoResource: optional and absent
  uint32_t version = 0;               ///< link of the resource's version chain that is read or written; Modify reads version − 1
  Access access = Access::Read;
  uint32_t use = 0;
  std::string meaning;
  bool frees = false;  ///< Modify: the memory is freed once the step has run
};

/// Before a step: `resource` was touched with `fromUse` (written or read), is now touched with `toUse`.
struct PlannedBarrier {
  ResourceId resource;
  uint32_t fromUse, toUse;
  bool writeBefore, writeAfter;
};

struct PlannedStep {
  uint32_t node;     ///< index in Graph::nodes()
  uint32_t segment;  ///< a submission ends where the segment number rises (counts must be read back)
  std::string type;
  bool hostPaced = false;
  bool everyFrame = false;
  std::vector<Declaration::PublishedCount> counts;  ///< that this node publishes
  std::vector<std::string> neededCounts;            ///< counts in the shapes of its ports, each once
  std::vector<PlannedPort> ports;
  std::vector<PlannedBarrier> barriers;  ///< as if every step ran; the executor narrows them to what did run
};

struct CulledNode {
  std::string name, type, reason;
};

struct Import {
  std::string name;  ///< "scene.vertices"
  Shape shape;
};

struct Plan {
  std::vector<PlannedStep> steps;  ///< in order
  std::vector<PlannedResource> resources;
  std::vector<CulledNode> culled;
  std::vector<std::pair<std::string, std::string>> advice;  ///< node, what it advises (Declaration::advise)
  std::vector<std::string> nodeNames;                       ///< of Graph::nodes()
  uint32_t segmentCount = 0;

  const PlannedPort* findPort(std::string_view node, std::string_view port) const;
  /// Bytes per resource where counts are known; the text lists order, segments, culled nodes and why, resources, aliasing, barriers.
  std::string printText(const Counts& counts) const;
  std::string printDot() const;
  std::string printJson(const Counts& counts) const;
};

struct CompileInput {
  const scene::Traits& traits;
  const scene::Request& request;
  const gpu::Capabilities& capabilities;  ///< default-constructed when there is no device
  std::vector<Import> imports;
  Counts knownCounts;     ///< "triangles", "vertices", "width", "height", …
  bool keepsAll = false;  ///< nothing is freed between steps (Port::frees): for hosts that look into what nodes hand on
};

/// Throws BadInput with every error of the graph in one message (unknown ports, wrong directions, kinds that differ, cycles, two
/// writers of one input, required inputs unconnected, a dead version read).
Plan compile(const Graph& graph, const CompileInput& input);

}  // namespace radivox::graph
