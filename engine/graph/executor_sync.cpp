// Barriers between steps that really ran: the last accesses of each piece of memory are remembered across steps, submissions and
// frames (all on one queue), so that skipped nodes need no care.
#include <algorithm>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {
namespace {

bool isDepth(VkFormat format) {
  return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_X8_D24_UNORM_PACK32;
}

VkPipelineStageFlags2 stagesOf(uint32_t use) {
  VkPipelineStageFlags2 stages = 0;
  if ((use & (UseCompute | UseAddress)) != 0) stages |= VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  if ((use & UseRaster) != 0) stages |= VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
  if ((use & UseAttachment) != 0) {
    stages |= VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
              VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
  }
  if ((use & UseTransfer) != 0) stages |= VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  if ((use & UseIndirect) != 0) stages |= VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
  if ((use & UseHost) != 0) stages |= VK_PIPELINE_STAGE_2_HOST_BIT;
  return stages;
}

VkAccessFlags2 readsOf(uint32_t use) {
  VkAccessFlags2 access = 0;
  if ((use & (UseCompute | UseRaster | UseAddress)) != 0) {
    access |= VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT;
  }
  if ((use & UseAttachment) != 0) access |= VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
  if ((use & UseTransfer) != 0) access |= VK_ACCESS_2_TRANSFER_READ_BIT;
  if ((use & UseIndirect) != 0) access |= VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT;
  if ((use & UseHost) != 0) access |= VK_ACCESS_2_HOST_READ_BIT;
  return access;
}

VkAccessFlags2 writesOf(uint32_t use) {
  VkAccessFlags2 access = 0;
  if ((use & (UseCompute | UseRaster | UseAddress)) != 0) access |= VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  if ((use & UseAttachment) != 0) access |= VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  if ((use & UseTransfer) != 0) access |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
  if ((use & UseHost) != 0) access |= VK_ACCESS_2_HOST_WRITE_BIT;
  return access;
}

VkImageLayout layoutFor(const gpu::Image& image, const PlannedPort& port) {
  if (!isDepth(image.info().format)) return VK_IMAGE_LAYOUT_GENERAL;
  if (port.access == Access::Read) return VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL;
  return (port.use & UseAttachment) != 0 ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_GENERAL;
}

VkImageMemoryBarrier2 imageBarrier(const gpu::Image& image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
  return barrier;
}

/// One vkCmdPipelineBarrier2: all buffers in one memory barrier, images on their own where their layout changes.
struct BarrierBatch {
  static constexpr size_t kMaxImages = 16;
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  VkImageMemoryBarrier2 images[kMaxImages];
  uint32_t imageCount = 0;

  void flush(VkCommandBuffer commands) {
    const bool hasMemory = memory.srcStageMask != 0;
    if (!hasMemory && imageCount == 0) return;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = hasMemory ? 1 : 0;
    info.pMemoryBarriers = &memory;
    info.imageMemoryBarrierCount = imageCount;
    info.pImageMemoryBarriers = images;
    vkCmdPipelineBarrier2(commands, &info);
    memory = VkMemoryBarrier2{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    imageCount = 0;
  }
};

void fullBarrier(VkCommandBuffer commands, VkPipelineStageFlags2 to, VkAccessFlags2 access) {
  BarrierBatch batch;
  batch.memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  batch.memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  batch.memory.dstStageMask = to;
  batch.memory.dstAccessMask = access;
  batch.flush(commands);
}

}  // namespace

const gpu::Buffer& Executor::Impl::bufferOf(ResourceId id) const {
  return plan.resources[id].imported ? *resources[id].importedBuffer : resources[memoryOf(id)].buffer;
}

gpu::Image& Executor::Impl::imageOf(ResourceId id) {
  return plan.resources[id].imported ? *resources[id].importedImage : resources[id].image;
}

AccessState& Executor::Impl::accessOf(ResourceId id) {
  const uint32_t slot = plan.resources[id].aliasSlot;
  return slot != kNoSlot ? slots[slot].access : resources[memoryOf(id)].access;
}

void Executor::Impl::synchronizeStep(VkCommandBuffer commands, uint32_t step) {
  BarrierBatch barriers;
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (port.resource == kNoResource) continue;
    AccessState& access = accessOf(port.resource);
    const bool writes = port.access != Access::Read;
    const bool scratch = port.access == Access::Scratch;
    const uint32_t before = access.writeUse | access.readUse;
    const bool needed = writes ? before != 0 : access.writeUse != 0 && (access.readUse & port.use) != port.use;
    bool transitions = false;
    if (plan.resources[port.resource].shape.kind == ResourceKind::Image) {
      gpu::Image& image = imageOf(port.resource);
      const VkImageLayout layout = layoutFor(image, port);
      const VkImageLayout from = scratch ? VK_IMAGE_LAYOUT_UNDEFINED : image.layout;
      if (from != layout) {
        transitions = true;
        if (barriers.imageCount == BarrierBatch::kMaxImages) barriers.flush(commands);
        VkImageMemoryBarrier2& barrier = barriers.images[barriers.imageCount++];
        barrier = imageBarrier(image, from, layout);
        // An import may have been left by anybody: wait for everything before.
        const bool unknown = before == 0 && from != VK_IMAGE_LAYOUT_UNDEFINED;
        barrier.srcStageMask = unknown ? VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT : stagesOf(before);
        barrier.srcAccessMask = unknown ? VK_ACCESS_2_MEMORY_WRITE_BIT : writesOf(access.writeUse);
        barrier.dstStageMask = stagesOf(port.use);
        barrier.dstAccessMask = readsOf(port.use) | writesOf(writes ? port.use : 0);
        image.layout = layout;
      }
    }
    if (needed && !transitions) {
      barriers.memory.srcStageMask |= stagesOf(before);
      barriers.memory.srcAccessMask |= writesOf(access.writeUse);
      barriers.memory.dstStageMask |= stagesOf(port.use);
      barriers.memory.dstAccessMask |= readsOf(port.use) | writesOf(writes ? port.use : 0);
    }
    if (writes) {
      access = {port.use, 0};
    } else if (transitions) {
      access = {port.use, port.use};  // the transition counts as a write that this use has seen
    } else {
      access.readUse |= port.use;
    }
  }
  barriers.flush(commands);
}

void Executor::Impl::zeroNewOutputs(VkCommandBuffer commands, uint32_t step) {
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (port.resource == kNoResource || port.access != Access::Write || !resources[port.resource].mustZero) continue;
    ResourceState& state = resources[port.resource];
    state.mustZero = false;
    if (plan.resources[port.resource].shape.kind == ResourceKind::Buffer) {
      vkCmdFillBuffer(commands, state.buffer.handle(), 0, VK_WHOLE_SIZE, 0);
    } else {
      BarrierBatch barriers;
      barriers.images[barriers.imageCount++] = imageBarrier(state.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
      barriers.images[0].dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
      barriers.images[0].dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
      barriers.flush(commands);
      const VkImageSubresourceRange range{state.image.aspect(), 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
      if (isDepth(state.image.info().format)) {
        const VkClearDepthStencilValue zero{};
        vkCmdClearDepthStencilImage(commands, state.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &range);
      } else {
        const VkClearColorValue zero{};
        vkCmdClearColorImage(commands, state.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &range);
      }
      state.image.layout = VK_IMAGE_LAYOUT_GENERAL;
    }
    state.access = {UseTransfer, 0};
  }
}

void Executor::Impl::synchronizeAll(VkCommandBuffer commands) {
  fullBarrier(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

void Executor::Impl::makeVisibleToHost(VkCommandBuffer commands) {
  fullBarrier(commands, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

}  // namespace radivox::graph
