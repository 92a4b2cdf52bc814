#include "engine/graph/executor.h"

#include <algorithm>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {
namespace {

class StepPrepareContext final : public PrepareContext {
 public:
  StepPrepareContext(Executor::Impl& impl, const PlannedStep& step) : impl_(impl), step_(step) {}
  gpu::Device& device() override { return impl_.device; }
  bool has(std::string_view port) const override {
    return std::any_of(step_.ports.begin(), step_.ports.end(),
                       [&](const PlannedPort& p) { return p.name == port && p.resource != kNoResource; });
  }
  const scene::Traits& traits() const override { return impl_.traits; }
  const scene::Request& request() const override { return impl_.request; }

 private:
  Executor::Impl& impl_;
  const PlannedStep& step_;
};

}  // namespace

Executor::Impl::Impl(gpu::Device& device_, Graph& graph_, Plan plan_, const scene::Traits& traits_, const scene::Request& request_,
                     Counts known)
    : device(device_), graph(graph_), plan(std::move(plan_)), traits(traits_), request(request_), counts(std::move(known)) {
  resources.resize(plan.resources.size());
  uint32_t slotCount = 0;
  for (ResourceId id = 0; id < resources.size(); ++id) {
    resources[id].versions.assign(plan.resources[id].versionCount, 0);
    if (plan.resources[id].aliasSlot != kNoSlot) slotCount = std::max(slotCount, plan.resources[id].aliasSlot + 1);
  }
  slots.resize(slotCount);
  steps.resize(plan.steps.size());
  stale.resize(plan.steps.size());
  linkSteps();
  uint32_t countWords = 0;
  for (uint32_t i = 0; i < steps.size(); ++i) {
    const PlannedStep& planned = plan.steps[i];
    StepState& state = steps[i];
    state.node = graph.nodes()[planned.node].node.get();
    state.context = std::make_unique<StepContext>(*this, i);
    state.planVersion = state.node->params().planVersion();
    state.seen.assign(planned.ports.size(), 0);
    state.seenBefore = state.seen;
    state.seenCounts.assign(planned.neededCounts.size(), 0);
    state.stats.name = nodeName(i);
    state.stats.type = planned.type;
    countWords += static_cast<uint32_t>(planned.counts.size());
  }
  for (uint32_t i = 0; i < steps.size(); ++i) {
    StepPrepareContext context(*this, plan.steps[i]);
    steps[i].node->prepare(context);
  }
  device.waitForPipelines();  // so that no node's time holds another's compilation
  descriptors = std::make_unique<gpu::DescriptorPool>(device);
  timestamps = gpu::Timestamps(device, 2 * static_cast<uint32_t>(steps.size()));
  countReadback = gpu::Buffer(device, "graph.counts", uint64_t{countWords} * 4, gpu::MemoryKind::ReadBack);
  VkCommandPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  poolInfo.queueFamilyIndex = device.queueFamily();
  gpu::check(vkCreateCommandPool(device.handle(), &poolInfo, nullptr, &commandPool), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = commandPool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  const VkResult result = vkAllocateCommandBuffers(device.handle(), &info, &commandBuffer);
  if (result != VK_SUCCESS) {
    vkDestroyCommandPool(device.handle(), commandPool, nullptr);
    gpu::check(result, "vkAllocateCommandBuffers");
  }
}

Executor::Impl::~Impl() {
  if (!inFlight.empty()) vkQueueWaitIdle(device.queue());
  for (uint32_t slot = 0; slot < slots.size(); ++slot) releaseSlot(slot);
  vkDestroyCommandPool(device.handle(), commandPool, nullptr);
}

Executor::Executor(gpu::Device& device, Graph& graph, Plan plan, const scene::Traits& traits, const scene::Request& request,
                   Counts knownCounts)
    : impl_(std::make_unique<Impl>(device, graph, std::move(plan), traits, request, std::move(knownCounts))) {}

Executor::~Executor() = default;

void Executor::importBuffer(std::string_view name, const gpu::Buffer& buffer, uint64_t version) {
  for (ResourceId id = 0; id < impl_->resources.size(); ++id) {
    const PlannedResource& planned = impl_->plan.resources[id];
    if (!planned.imported || planned.name != name) continue;
    if (planned.shape.kind != ResourceKind::Buffer)
      throw Error(ErrorCode::BadInput, "import " + planned.name + " is an image in the plan, not a buffer");
    impl_->resources[id].importedBuffer = &buffer;
    impl_->resources[id].bytes = buffer.bytes();
    impl_->resources[id].versions[0] = version;
  }
}

void Executor::importImage(std::string_view name, gpu::Image& image, uint64_t version) {
  for (ResourceId id = 0; id < impl_->resources.size(); ++id) {
    const PlannedResource& planned = impl_->plan.resources[id];
    if (!planned.imported || planned.name != name) continue;
    if (planned.shape.kind != ResourceKind::Image)
      throw Error(ErrorCode::BadInput, "import " + planned.name + " is a buffer in the plan, not an image");
    impl_->resources[id].importedImage = &image;
    impl_->resources[id].versions[0] = version;
  }
}

void Executor::setCount(std::string_view name, uint64_t value) {
  for (const PlannedStep& step : impl_->plan.steps) {
    for (const auto& published : step.counts) {
      if (published.name != name) continue;
      throw Error(ErrorCode::BadInput, "the count " + published.name + " is published by " + impl_->plan.nodeNames[step.node] +
                                           "; only known counts can be set");
    }
  }
  impl_->counts[std::string(name)] = value;
}

void Executor::run(const Progress& progress, const std::function<bool()>& cancelled) {
  impl_->progress = progress;
  impl_->cancelled = cancelled;
  struct Reset {
    Impl& impl;
    ~Reset() {
      impl.progress = nullptr;
      impl.cancelled = nullptr;
    }
  } reset{*impl_};
  impl_->run();
}

bool Executor::isReadyToRecord() const { return impl_->isReadyToRecord(); }
void Executor::record(VkCommandBuffer commands) { impl_->record(commands); }
void Executor::frameCompleted() { impl_->frameCompleted(); }

namespace {

const PlannedPort* findPresent(const Plan& plan, std::string_view nodePort) {
  const size_t dot = nodePort.find('.');
  if (dot == std::string_view::npos) return nullptr;
  const PlannedPort* port = plan.findPort(nodePort.substr(0, dot), nodePort.substr(dot + 1));
  return port == nullptr || port->resource == kNoResource ? nullptr : port;
}

}  // namespace

const gpu::Buffer* Executor::findBuffer(std::string_view nodePort) const {
  const PlannedPort* port = findPresent(impl_->plan, nodePort);
  if (port == nullptr || impl_->plan.resources[port->resource].shape.kind != ResourceKind::Buffer) return nullptr;
  if (impl_->plan.resources[port->resource].imported) return impl_->resources[port->resource].importedBuffer;
  const gpu::Buffer& buffer = impl_->resources[port->resource].buffer;
  return buffer ? &buffer : nullptr;
}

gpu::Image* Executor::findImage(std::string_view nodePort) const {
  const PlannedPort* port = findPresent(impl_->plan, nodePort);
  if (port == nullptr || impl_->plan.resources[port->resource].shape.kind != ResourceKind::Image) return nullptr;
  if (impl_->plan.resources[port->resource].imported) return impl_->resources[port->resource].importedImage;
  gpu::Image& image = impl_->resources[port->resource].image;
  return image ? &image : nullptr;
}

std::vector<const gpu::Buffer*> Executor::findGrown(std::string_view nodePort) const {
  std::vector<const gpu::Buffer*> buffers;
  const PlannedPort* port = findPresent(impl_->plan, nodePort);
  if (port == nullptr) return buffers;
  for (const auto& buffer : impl_->resources[port->resource].grown) buffers.push_back(buffer.get());
  return buffers;
}

const Counts& Executor::counts() const { return impl_->counts; }
const Plan& Executor::plan() const { return impl_->plan; }

FrameStats Executor::stats() const {
  FrameStats stats;
  for (const StepState& step : impl_->steps) stats.nodes.push_back(step.stats);
  for (ResourceId id = 0; id < impl_->resources.size(); ++id) {
    const PlannedResource& planned = impl_->plan.resources[id];
    const ResourceState& state = impl_->resources[id];
    if (planned.imported || !state.allocated) continue;
    stats.resources.push_back({planned.name, planned.shape.print(), planned.meaning, state.bytes, planned.scratch});
  }
  stats.culled = impl_->plan.culled;
  stats.counts = impl_->counts;
  stats.memory = impl_->device.memoryUse();
  stats.wallMs = impl_->frameWallMs;
  return stats;
}

}  // namespace radivox::graph
