// Runs a plan: allocates, tracks versions, skips what did not change, places barriers, measures.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/graph/plan.h"

namespace radivox::graph {

struct NodeStats {
  std::string name, type;
  uint32_t runCount = 0;  ///< since the executor was made
  bool ranLastFrame = false;
  double gpuMs = 0;                       ///< GPU timestamps, sum over the steps of the last run; 0 without timestamps
  double wallMs = 0;                      ///< last run, recording + waiting where the node is host-paced or ends a segment
  std::map<std::string, double> figures;  ///< reportStat
};

struct ResourceStats {
  std::string name, shape, meaning;
  uint64_t bytes = 0;    ///< as asked for
  bool scratch = false;  ///< shares memory with other scratch: the sum of these is more than is allocated
};

struct FrameStats {
  std::vector<NodeStats> nodes;
  std::vector<ResourceStats> resources;  ///< allocated now
  std::vector<CulledNode> culled;
  Counts counts;
  gpu::MemoryUse memory;  ///< of the whole device, as allocated
  double wallMs = 0;
};

using Progress = std::function<void(std::string_view node, double fraction)>;

class Executor {
 public:
  /// `graph` must outlive the executor. Prepares all pipelines.
  Executor(gpu::Device& device, Graph& graph, Plan plan, const scene::Traits& traits, const scene::Request& request, Counts knownCounts);
  ~Executor();

  /// Imports; the resource must outlive the executor or be replaced. A new `version` makes its readers run.
  void importBuffer(std::string_view name, const gpu::Buffer& buffer, uint64_t version);
  void importImage(std::string_view name, gpu::Image& image, uint64_t version);

  /// Another value for a count that no node publishes ("width" and "height" after a resize): what it shapes is made anew by the next
  /// run(), everything else stays. Traits and request keep what they say.
  void setCount(std::string_view name, uint64_t value);

  /// Runs what is stale on our own command buffers and waits. `progress` is called from this thread. `cancelled`, asked between steps,
  /// ends the run with Error(BadInput, "interrupted").
  void run(const Progress& progress = {}, const std::function<bool()>& cancelled = {});

  /// Embedding: true when the next frame needs no host-paced step or new count, so that record() can be used.
  bool isReadyToRecord() const;
  /// Records the next frame into the host's command buffer; the host submits it and calls frameCompleted() when it is done.
  void record(VkCommandBuffer commands);
  void frameCompleted();

  /// Resources by "node.port". Null when left out. Images are in layout GENERAL.
  const gpu::Buffer* findBuffer(std::string_view nodePort) const;
  gpu::Image* findImage(std::string_view nodePort) const;
  std::vector<const gpu::Buffer*> findGrown(std::string_view nodePort) const;
  const Counts& counts() const;
  const Plan& plan() const;
  FrameStats stats() const;

  struct Impl;  ///< private to engine/graph

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace radivox::graph
