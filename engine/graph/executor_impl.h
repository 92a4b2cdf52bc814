// Inside of the executor. Private to engine/graph.
//
//   executor.cpp           the public face, stats
//   executor_run.cpp       batches, host-paced steps, recording for a host
//   executor_schedule.cpp  what is stale
//   executor_memory.cpp    allocation, alias slots, limits
//   executor_sync.cpp      barriers from what really ran
//   executor_context.cpp   what a node sees
#pragma once

#include <chrono>

#include "engine/error.h"
#include "engine/gpu/timestamps.h"
#include "engine/graph/executor.h"

namespace radivox::graph {

/// Stages and accesses since the last write of a piece of memory, as masks of Use.
struct AccessState {
  uint32_t writeUse = 0;
  uint32_t readUse = 0;  ///< of the reads that the last write was made visible to
};
constexpr uint32_t kNoLink = 0xfffffffeu;  ///< + 1 is no link either
constexpr uint32_t kAllUses = UseCompute | UseRaster | UseAttachment | UseTransfer | UseIndirect | UseHost | UseAddress;

struct ResourceState {
  gpu::Buffer buffer;
  gpu::Image image;
  const gpu::Buffer* importedBuffer = nullptr;
  gpu::Image* importedImage = nullptr;
  std::vector<std::unique_ptr<gpu::Buffer>> grown;
  bool allocated = false;
  bool mustZero = false;           ///< persistent and newly made
  uint64_t bytes = 0;              ///< as asked for
  uint64_t extent[3] = {0, 0, 0};  ///< of an image
  std::vector<uint64_t> versions;  ///< per link of the version chain
  uint32_t currentLink = 0;        ///< link that the memory holds now
  AccessState access;
};

struct SlotState {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  uint64_t bytes = 0;
  AccessState access;
};

constexpr uint32_t kNoStep = 0xffffffffu;

/// Who writes and who reads one version of a resource, as positions in Plan::steps.
struct VersionLink {
  uint32_t writer = kNoStep;  ///< none: an import
  std::vector<uint32_t> readers;
};

class StepContext;

struct StepState {
  Node* node = nullptr;
  std::unique_ptr<StepContext> context;
  bool everRan = false;
  bool ranThisFrame = false;
  uint32_t runsThisFrame = 0;
  uint64_t paramsVersion = 0;
  uint64_t planVersion = 0;          ///< of the parameters, when the plan was made
  std::vector<uint64_t> seen;        ///< per port: input version of the last run
  std::vector<uint64_t> seenBefore;  ///< of the run before
  std::vector<uint64_t> seenCounts;  ///< per PlannedStep::neededCounts
  bool firstRun = true;              ///< of the last run
  NodeStats stats;
};

struct Executor::Impl {
  Impl(gpu::Device& device, Graph& graph, Plan plan, const scene::Traits& traits, const scene::Request& request, Counts known);
  ~Impl();

  gpu::Device& device;
  Graph& graph;
  const Plan plan;
  const scene::Traits traits;
  const scene::Request request;
  Counts counts;

  std::vector<ResourceState> resources;         // as Plan::resources
  std::vector<StepState> steps;                 // as Plan::steps
  std::vector<SlotState> slots;                 // by alias slot
  std::vector<std::vector<VersionLink>> links;  // per resource and version
  std::vector<char> stale;                      // scratch of findStale, per step
  uint64_t nextVersion = 1;
  double frameWallMs = 0;

  // Our own submissions.
  VkCommandPool commandPool = VK_NULL_HANDLE;
  VkCommandBuffer commandBuffer = VK_NULL_HANDLE;
  std::unique_ptr<gpu::DescriptorPool> descriptors;
  gpu::Timestamps timestamps;                                        ///< two queries a step
  gpu::Buffer countReadback;                                         ///< one word per published count
  std::vector<std::pair<gpu::Image*, VkImageLayout>> layoutsBefore;  ///< of images that the open batch touches
  Progress progress;
  std::function<bool()> cancelled;

  // Frames recorded into a host's command buffer, oldest first.
  struct RecordedFrame {
    std::unique_ptr<gpu::DescriptorPool> descriptors;
    gpu::Timestamps timestamps;
    std::vector<uint32_t> steps;
  };
  std::vector<std::unique_ptr<RecordedFrame>> inFlight, spare;

  const std::string& nodeName(uint32_t step) const { return plan.nodeNames[plan.steps[step].node]; }
  std::string portName(uint32_t step, const PlannedPort& port) const { return nodeName(step) + "." + port.name; }

  // Schedule.
  void linkSteps();
  void requireImports() const;
  std::string missingImports() const;
  void requireCurrentPlan() const;
  bool isPlanCurrent() const;
  bool isStale(uint32_t step, bool nextFrame) const;
  void findStale(bool nextFrame);

  // Memory.
  /// The resource that holds it: itself, or the output whose memory a scratch resource is lent.
  ResourceId memoryOf(ResourceId id) const { return plan.resources[id].lender != kNoResource ? plan.resources[id].lender : id; }
  void allocateOutput(ResourceId id, uint32_t use);
  void allocateOutputs(uint32_t step);
  void allocateScratch(const std::vector<uint32_t>& batchSteps);
  void freeScratch(const std::vector<uint32_t>& batchSteps);
  void releaseSlot(uint32_t slot);
  /// What the step was the only one to read (Port::frees).
  void freeRead(uint32_t step);
  bool isAllocated(uint32_t step) const;
  void checkBuffer(const std::string& name, uint64_t bytes, bool bound) const;
  gpu::ImageInfo imageInfo(const std::string& name, const Shape& shape) const;
  uint64_t bufferBytes(const std::string& name, const Shape& shape) const;

  // Barriers.
  const gpu::Buffer& bufferOf(ResourceId id) const;
  gpu::Image& imageOf(ResourceId id);
  AccessState& accessOf(ResourceId id);
  void synchronizeStep(VkCommandBuffer commands, uint32_t step);
  void zeroNewOutputs(VkCommandBuffer commands, uint32_t step);
  void synchronizeAll(VkCommandBuffer commands);
  void makeVisibleToHost(VkCommandBuffer commands);

  // Running.
  void run();
  void beginCommands();
  void submit();
  void recordStep(gpu::Commands& commands, const gpu::Timestamps& times, uint32_t step);
  double elapsedMs(const gpu::Timestamps& times, uint32_t step) const;
  void beginStep(uint32_t step);
  void endStep(uint32_t step);
  void runBatch(uint32_t first);
  void runHostPaced(uint32_t step);
  void copyCounts(VkCommandBuffer commands, const std::vector<uint32_t>& batchSteps);
  void readCounts(const std::vector<uint32_t>& batchSteps);
  void rememberLayouts(const std::vector<uint32_t>& batchSteps);
  void abandon(const std::vector<uint32_t>& batchSteps);
  void throwIfCancelled() const;
  bool isReadyToRecord();
  void record(VkCommandBuffer commands);
  void frameCompleted();

  static double now() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
};

/// What one node sees, for the life of the executor.
class StepContext final : public RecordContext {
 public:
  StepContext(Executor::Impl& impl, uint32_t step) : impl_(impl), step_(step) {}

  gpu::Commands& commands() override;
  bool has(std::string_view port) const override;
  const gpu::Buffer& buffer(std::string_view port) override;
  gpu::Image& image(std::string_view port) override;
  uint64_t count(std::string_view name) const override;
  bool changed(std::string_view inputPort) const override;
  bool firstRun() const override { return impl_.steps[step_].firstRun; }
  uint32_t step() const override { return hostStep; }
  const scene::Traits& traits() const override { return impl_.traits; }
  const scene::Request& request() const override { return impl_.request; }
  const gpu::Buffer& grow(std::string_view port, uint64_t bytes) override;
  void clearGrown(std::string_view port) override;
  std::vector<const gpu::Buffer*> grown(std::string_view port) const override;
  std::vector<std::byte> readBuffer(std::string_view port, uint64_t offset, uint64_t bytes) override;
  void setCount(std::string_view name, uint64_t value) override;
  void reportProgress(double fraction) override;
  void reportStat(std::string_view name, double value) override;

  gpu::Commands* current = nullptr;  ///< while recording
  uint32_t hostStep = 0;
  bool reportedProgress = false;

 private:
  size_t portIndex(std::string_view port) const;
  ResourceState& growable(std::string_view port);
  ResourceId resource(std::string_view port) const;
  Executor::Impl& impl_;
  uint32_t step_;
};

}  // namespace radivox::graph
