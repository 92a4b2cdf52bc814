// Running: batches of steps between waits, host-paced steps, recording for a host.
//
// A batch ends where counts must be read back, before a host-paced node, or with the frame. After each batch what is stale is asked
// anew, since a count that changed makes the nodes shaped by it stale.
#include <algorithm>
#include <cassert>
#include <cstring>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {

void Executor::Impl::throwIfCancelled() const {
  if (cancelled && cancelled()) throw Error(ErrorCode::BadInput, "interrupted");
}

void Executor::Impl::beginCommands() {
  gpu::check(vkResetCommandPool(device.handle(), commandPool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(vkBeginCommandBuffer(commandBuffer, &info), "vkBeginCommandBuffer");
  descriptors->reset();
  timestamps.reset(commandBuffer);
}

void Executor::Impl::submit() {
  gpu::check(vkEndCommandBuffer(commandBuffer), "vkEndCommandBuffer");
  device.submitAndWait(commandBuffer);
}

void Executor::Impl::beginStep(uint32_t step) {
  StepState& state = steps[step];
  const PlannedStep& planned = plan.steps[step];
  const uint64_t paramsVersion = state.node->params().version();
  state.firstRun = !state.everRan || paramsVersion != state.paramsVersion;
  state.paramsVersion = paramsVersion;
  state.seenBefore = state.seen;
  for (size_t p = 0; p < planned.ports.size(); ++p) {
    const PlannedPort& port = planned.ports[p];
    if (port.resource == kNoResource || (port.access != Access::Read && port.access != Access::Modify)) continue;
    state.seen[p] = resources[port.resource].versions[port.access == Access::Modify ? port.version - 1 : port.version];
  }
  for (size_t c = 0; c < planned.neededCounts.size(); ++c) state.seenCounts[c] = counts.at(planned.neededCounts[c]);
}

void Executor::Impl::endStep(uint32_t step) {
  StepState& state = steps[step];
  state.everRan = true;
  state.ranThisFrame = true;
  ++state.runsThisFrame;
  ++state.stats.runCount;
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (port.resource == kNoResource || (port.access != Access::Write && port.access != Access::Modify)) continue;
    resources[port.resource].versions[port.version] = nextVersion++;
    resources[port.resource].currentLink = port.version;
  }
}

double Executor::Impl::elapsedMs(const gpu::Timestamps& times, uint32_t step) const { return times.readNs(2 * step, 2)[1] * 1e-6; }

void Executor::Impl::recordStep(gpu::Commands& commands, const gpu::Timestamps& times, uint32_t step) {
  const double start = now();
  beginStep(step);
  times.write(commands.handle(), 2 * step);
  zeroNewOutputs(commands.handle(), step);
  synchronizeStep(commands.handle(), step);
  StepContext& context = *steps[step].context;
  context.current = &commands;
  context.hostStep = 0;
  steps[step].node->record(context);
  context.current = nullptr;
  times.write(commands.handle(), 2 * step + 1);
  endStep(step);
  steps[step].stats.wallMs = now() - start;
}

void Executor::Impl::copyCounts(VkCommandBuffer commands, const std::vector<uint32_t>& batchSteps) {
  uint32_t word = 0;
  for (uint32_t i = 0; i < steps.size(); ++i) {
    for (const auto& published : plan.steps[i].counts) {
      const uint32_t slot = word++;
      if (published.port.empty() || std::find(batchSteps.begin(), batchSteps.end(), i) == batchSteps.end()) continue;
      const PlannedPort* port = plan.findPort(nodeName(i), published.port);
      AccessState& access = accessOf(port->resource);
      VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
      memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
      memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
      memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
      memory.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
      VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
      info.memoryBarrierCount = 1;
      info.pMemoryBarriers = &memory;
      vkCmdPipelineBarrier2(commands, &info);
      access.readUse |= UseTransfer;
      const VkBufferCopy region{published.byteOffset, uint64_t{slot} * 4, 4};
      vkCmdCopyBuffer(commands, bufferOf(port->resource).handle(), countReadback.handle(), 1, &region);
    }
  }
}

void Executor::Impl::readCounts(const std::vector<uint32_t>& batchSteps) {
  uint32_t slot = 0;
  for (uint32_t i = 0; i < steps.size(); ++i) {
    for (const auto& published : plan.steps[i].counts) {
      const size_t offset = size_t{slot++} * 4;
      if (published.port.empty() || std::find(batchSteps.begin(), batchSteps.end(), i) == batchSteps.end()) continue;
      uint32_t value = 0;
      std::memcpy(&value, static_cast<const std::byte*>(countReadback.mapped()) + offset, sizeof value);
      counts[published.name] = value;
    }
  }
}

void Executor::Impl::rememberLayouts(const std::vector<uint32_t>& batchSteps) {
  layoutsBefore.clear();
  for (const uint32_t step : batchSteps) {
    for (const PlannedPort& port : plan.steps[step].ports) {
      if (port.resource == kNoResource || plan.resources[port.resource].shape.kind != ResourceKind::Image) continue;
      gpu::Image& image = imageOf(port.resource);
      layoutsBefore.emplace_back(&image, image.layout);
    }
  }
}

void Executor::Impl::abandon(const std::vector<uint32_t>& batchSteps) {
  // Nothing of the open command buffer happened: what it would have written is void.
  for (const auto& [image, layout] : layoutsBefore) image->layout = layout;
  for (const uint32_t step : batchSteps) {
    steps[step].everRan = false;
    steps[step].context->current = nullptr;
    for (const PlannedPort& port : plan.steps[step].ports) {
      if (port.resource == kNoResource) continue;
      accessOf(port.resource) = {kAllUses & ~UseHost, 0};
      if (plan.resources[port.resource].persistent && port.access == Access::Write) resources[port.resource].mustZero = true;
      if (port.access == Access::Modify) resources[port.resource].currentLink = kNoLink;  // no link: the writer runs again
    }
  }
  layoutsBefore.clear();
}

void Executor::Impl::runBatch(uint32_t first) {
  std::vector<uint32_t> members;
  std::vector<uint32_t> publishedSegments;
  bool more = false;
  for (uint32_t i = first; i < steps.size(); ++i) {
    if (stale[i] == 0) continue;
    const PlannedStep& planned = plan.steps[i];
    const bool waits = std::any_of(publishedSegments.begin(), publishedSegments.end(), [&](uint32_t s) { return s < planned.segment; });
    more = waits || planned.hostPaced;
    if (more) break;
    members.push_back(i);
    if (!planned.counts.empty()) publishedSegments.push_back(planned.segment);
  }
  // A node runs again in one frame only when a later one that modifies its output turned stale by a count of this frame.
  assert(std::all_of(members.begin(), members.end(), [&](uint32_t step) { return steps[step].runsThisFrame <= steps.size(); }));
  bool open = false;
  layoutsBefore.clear();
  try {
    for (const uint32_t step : members) allocateOutputs(step);
    allocateScratch(members);
    rememberLayouts(members);
    beginCommands();
    open = true;
    gpu::Commands commands(device, commandBuffer, *descriptors);
    for (const uint32_t step : members) {
      if (progress) progress(nodeName(step), 0.0);
      recordStep(commands, timestamps, step);
    }
    copyCounts(commandBuffer, members);
    makeVisibleToHost(commandBuffer);
    const double start = now();
    submit();
    steps[members.back()].stats.wallMs += now() - start;
  } catch (...) {
    if (open) vkResetCommandPool(device.handle(), commandPool, 0);
    abandon(members);
    throw;
  }
  layoutsBefore.clear();
  readCounts(members);
  for (const uint32_t step : members) steps[step].stats.gpuMs = elapsedMs(timestamps, step);
  if (progress) {
    for (const uint32_t step : members) progress(nodeName(step), 1.0);
  }
  // A preparation that was waited for gives its scratch memory back; the frame's steady last batch keeps it.
  if (more || !publishedSegments.empty()) freeScratch(members);
}

void Executor::Impl::runHostPaced(uint32_t step) {
  StepState& state = steps[step];
  StepContext& context = *state.context;
  const std::vector<uint32_t> members{step};
  const double start = now();
  layoutsBefore.clear();
  try {
    allocateOutputs(step);
    allocateScratch(members);
    beginStep(step);
    context.reportedProgress = false;
    context.hostStep = 0;
    if (progress) progress(nodeName(step), 0.0);
    uint32_t stepCount = state.node->stepCount(context);
    state.stats.gpuMs = 0;
    for (uint32_t i = 0; i < stepCount; ++i) {
      throwIfCancelled();
      context.hostStep = i;
      rememberLayouts(members);
      beginCommands();
      if (i == 0) {
        zeroNewOutputs(commandBuffer, step);
        synchronizeStep(commandBuffer, step);
      }
      // What the step before wrote, and growable buffers of steps before.
      synchronizeAll(commandBuffer);
      gpu::Commands commands(device, commandBuffer, *descriptors);
      context.current = &commands;
      timestamps.write(commandBuffer, 2 * step);
      state.node->record(context);
      timestamps.write(commandBuffer, 2 * step + 1);
      context.current = nullptr;
      makeVisibleToHost(commandBuffer);
      const double submitted = now();
      submit();
      // Timestamps of a CPU device miss some dispatches altogether; it is the host that computes, so its time is theirs.
      const bool onHost = device.capabilities().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
      state.stats.gpuMs += onHost ? std::max(elapsedMs(timestamps, step), now() - submitted) : elapsedMs(timestamps, step);
      state.node->stepDone(context);
      stepCount = state.node->stepCount(context);
      if (progress && !context.reportedProgress) progress(nodeName(step), double(i + 1) / double(std::max(stepCount, i + 1)));
    }
    const bool copies =
        std::any_of(plan.steps[step].counts.begin(), plan.steps[step].counts.end(), [](const auto& c) { return !c.port.empty(); });
    if (copies) {
      beginCommands();
      copyCounts(commandBuffer, members);
      makeVisibleToHost(commandBuffer);
      submit();
    }
    endStep(step);
    readCounts(members);
    freeRead(step);
  } catch (...) {
    vkResetCommandPool(device.handle(), commandPool, 0);
    abandon(members);
    throw;
  }
  state.stats.wallMs = now() - start;
  freeScratch(members);
}

void Executor::Impl::run() {
  const double start = now();
  if (!inFlight.empty()) {
    throw Error(ErrorCode::BadInput,
                "run() while " + std::to_string(inFlight.size()) + " recorded frames are unfinished; call frameCompleted()");
  }
  requireImports();
  requireCurrentPlan();
  for (StepState& state : steps) {
    state.ranThisFrame = false;
    state.runsThisFrame = 0;
  }
  while (true) {
    findStale(false);
    const auto first = std::find(stale.begin(), stale.end(), char{1});
    if (first == stale.end()) break;
    throwIfCancelled();
    const auto step = static_cast<uint32_t>(first - stale.begin());
    if (plan.steps[step].hostPaced) {
      runHostPaced(step);
    } else {
      runBatch(step);
    }
  }
  for (StepState& state : steps) {
    state.stats.ranLastFrame = state.ranThisFrame;
    if (state.ranThisFrame) state.node->frameDone(*state.context);
  }
  frameWallMs = now() - start;
}

bool Executor::Impl::isReadyToRecord() {
  if (!missingImports().empty() || !isPlanCurrent()) return false;
  findStale(true);
  for (uint32_t i = 0; i < steps.size(); ++i) {
    if (stale[i] == 0) continue;
    const PlannedStep& planned = plan.steps[i];
    if (planned.hostPaced || !planned.counts.empty() || !isAllocated(i)) return false;
    for (size_t c = 0; c < planned.neededCounts.size(); ++c) {
      const auto known = counts.find(planned.neededCounts[c]);
      if (known == counts.end() || known->second != steps[i].seenCounts[c]) return false;
    }
  }
  return true;
}

void Executor::Impl::record(VkCommandBuffer target) {
  const double start = now();
  if (!isReadyToRecord()) throw Error(ErrorCode::BadInput, "record() while isReadyToRecord() is false; call run() for this frame");
  if (spare.empty()) {
    spare.push_back(std::make_unique<RecordedFrame>());
    spare.back()->descriptors = std::make_unique<gpu::DescriptorPool>(device);
    spare.back()->timestamps = gpu::Timestamps(device, 2 * static_cast<uint32_t>(steps.size()));
    spare.back()->steps.reserve(steps.size());
  }
  RecordedFrame& frame = *spare.back();
  gpu::Commands commands(device, target, *frame.descriptors);
  frame.timestamps.reset(target);
  synchronizeAll(target);  // whatever the host wrote into its imports in this command buffer
  for (uint32_t i = 0; i < steps.size(); ++i) {
    steps[i].ranThisFrame = false;
    if (stale[i] == 0) continue;
    recordStep(commands, frame.timestamps, i);
    frame.steps.push_back(i);
  }
  synchronizeAll(target);  // the host may use outputs at once, in any stage
  makeVisibleToHost(target);
  inFlight.push_back(std::move(spare.back()));
  spare.pop_back();
  for (StepState& state : steps) state.stats.ranLastFrame = state.ranThisFrame;
  frameWallMs = now() - start;
}

void Executor::Impl::frameCompleted() {
  if (inFlight.empty()) throw Error(ErrorCode::BadInput, "frameCompleted() without a recorded frame");
  RecordedFrame& frame = *inFlight.front();
  for (const uint32_t step : frame.steps) {
    steps[step].stats.gpuMs = elapsedMs(frame.timestamps, step);
    steps[step].node->frameDone(*steps[step].context);
  }
  frame.steps.clear();
  frame.descriptors->reset();
  spare.push_back(std::move(inFlight.front()));
  inFlight.erase(inFlight.begin());
}

}  // namespace radivox::graph
