#include "engine/gpu/commands.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "engine/gpu/staging.h"

namespace radivox::gpu {

namespace {

bool isReadableDepth(VkImageLayout layout) {
  return layout == VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL || layout == VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL ||
         layout == VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL || layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL ||
         layout == VK_IMAGE_LAYOUT_GENERAL;
}

VkImageLayout sampledLayout(const Image& image) {
  if (image.aspect() == VK_IMAGE_ASPECT_DEPTH_BIT) {
    return isReadableDepth(image.layout) ? image.layout : VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL;
  }
  const bool readOnly = image.layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL || image.layout == VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL;
  return readOnly ? image.layout : VK_IMAGE_LAYOUT_GENERAL;
}

/// At most the device's range; past it a buffer is reached by address only.
VkDescriptorBufferInfo describeBuffer(const Capabilities& can, const BoundResource& resource, BindingType type) {
  const Buffer& buffer = *resource.buffer;
  const VkDeviceSize limit = type == BindingType::UniformBuffer ? can.maxUniformBufferRange : can.maxStorageBufferRange;
  assert(resource.offset < buffer.bytes() && resource.offset % can.storageOffsetAlignment == 0);
  const VkDeviceSize left = (buffer.bytes() + 3) / 4 * 4 - resource.offset;
  return {buffer.handle(), resource.offset, std::min({resource.range, left, limit / 4 * 4})};
}

}  // namespace

void Commands::bind(const Pipeline& pipeline, std::initializer_list<BoundResource> resources) {
  bind(pipeline, std::span<const BoundResource>(resources.begin(), resources.size()));
}

void Commands::bind(const Pipeline& pipeline, std::span<const BoundResource> resources) {
  assert(pipeline && resources.size() == pipeline.bindings().size());
  bound_ = &pipeline;
  vkCmdBindPipeline(commands_, pipeline.bindPoint(), pipeline.handle());
  if (resources.empty()) return;

  std::array<VkWriteDescriptorSet, kMaxBindings> writes;
  std::array<VkDescriptorBufferInfo, kMaxBindings> buffers;
  std::array<VkDescriptorImageInfo, kMaxBindings> images;
  std::array<VkBufferView, kMaxBindings> texels;
  const VkDescriptorSet set = device_.cmdPushDescriptorSet != nullptr ? VK_NULL_HANDLE : pool_.take(pipeline);
  for (size_t i = 0; i < resources.size(); ++i) {
    const BoundResource& resource = resources[i];
    const BindingType type = pipeline.bindings()[i];
    VkWriteDescriptorSet& write = writes[i];
    write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = static_cast<uint32_t>(i);
    write.descriptorCount = 1;
    switch (type) {
      case BindingType::StorageBuffer:
      case BindingType::UniformBuffer: {
        assert(resource.buffer != nullptr && "an image where the pipeline wants a buffer");
        const BoundResource given = *resource.buffer ? resource : BoundResource(pool_.placeholder());
        buffers[i] = describeBuffer(device_.capabilities(), given, type);
        write.descriptorType = type == BindingType::StorageBuffer ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        write.pBufferInfo = &buffers[i];
        break;
      }
      case BindingType::TexelBuffer: {
        assert(resource.buffer != nullptr && resource.offset == 0 && "an image or a part of a buffer where the pipeline wants texels");
        texels[i] = (*resource.buffer ? *resource.buffer : pool_.placeholder()).texels(pipeline.imageKinds()[i].texel);
        write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        write.pTexelBufferView = &texels[i];
        break;
      }
      case BindingType::StorageImage:
      case BindingType::SampledImage: {
        assert(resource.image != nullptr && "a buffer where the pipeline wants an image");
        const Image& image = *resource.image ? *resource.image : pool_.placeholder(pipeline.imageKinds()[i]);
        const bool sampled = type == BindingType::SampledImage;
        images[i] = {sampled ? pool_.nearestSampler() : VK_NULL_HANDLE, image.view(),
                     sampled ? sampledLayout(image) : VK_IMAGE_LAYOUT_GENERAL};
        write.descriptorType = sampled ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        write.pImageInfo = &images[i];
        break;
      }
    }
  }
  const auto count = static_cast<uint32_t>(resources.size());
  if (device_.cmdPushDescriptorSet != nullptr) {
    device_.cmdPushDescriptorSet(commands_, pipeline.bindPoint(), pipeline.layout(), 0, count, writes.data());
  } else {
    vkUpdateDescriptorSets(device_.handle(), count, writes.data(), 0, nullptr);
    vkCmdBindDescriptorSets(commands_, pipeline.bindPoint(), pipeline.layout(), 0, 1, &set, 0, nullptr);
  }
}

void Commands::pushBytes(const void* data, uint32_t bytes) {
  assert(bound_ != nullptr && bytes <= (bound_->pushConstantBytes() + 3) / 4 * 4 && bytes % 4 == 0);
  vkCmdPushConstants(commands_, bound_->layout(), bound_->stages(), 0, bytes, data);
}

void Commands::dispatch(uint32_t groupsX, uint32_t groupsY, uint32_t groupsZ) {
  if (groupsX == 0 || groupsY == 0 || groupsZ == 0) return;
  vkCmdDispatch(commands_, groupsX, groupsY, groupsZ);
}

void Commands::dispatchItems(uint64_t itemCount, uint32_t groupSize) {
  if (itemCount == 0) return;
  const uint64_t groups = (itemCount - 1) / groupSize + 1;
  const uint64_t rows = (groups - 1) / kMaxGroupsX + 1;
  assert(rows <= 65535 && "more items than a dispatch can hold");
  vkCmdDispatch(commands_, static_cast<uint32_t>(std::min<uint64_t>(groups, kMaxGroupsX)), static_cast<uint32_t>(rows), 1);
}

void Commands::dispatchIndirect(const Buffer& arguments, VkDeviceSize offset) {
  vkCmdDispatchIndirect(commands_, arguments.handle(), offset);
}

void Commands::draw(uint32_t vertexCount, uint32_t instanceCount) { vkCmdDraw(commands_, vertexCount, instanceCount, 0, 0); }

void Commands::fill(const Buffer& buffer, uint32_t value, VkDeviceSize offset, VkDeviceSize bytes) {
  if (bytes == 0) return;
  vkCmdFillBuffer(commands_, buffer.handle(), offset, bytes == VK_WHOLE_SIZE ? VK_WHOLE_SIZE : (bytes + 3) / 4 * 4, value);
}

void Commands::update(const Buffer& buffer, const void* data, VkDeviceSize bytes, VkDeviceSize offset) {
  assert(bytes <= 65536 && bytes % 4 == 0 && offset % 4 == 0);
  if (bytes > 0) vkCmdUpdateBuffer(commands_, buffer.handle(), offset, bytes, data);
}

void Commands::copy(const Buffer& from, const Buffer& to, VkDeviceSize bytes, VkDeviceSize fromOffset, VkDeviceSize toOffset) {
  if (bytes == 0) return;
  const VkBufferCopy region{fromOffset, toOffset, bytes};
  vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void Commands::barrier() { recordFullBarrier(commands_); }

void Commands::transition(Image& image, VkImageLayout to) {
  recordTransition(commands_, image.handle(), layoutAspects(image.info().format), image.layout, to);
  image.layout = to;
}

void Commands::beginRendering(VkExtent2D extent, std::span<const Attachment> color, const Attachment* depth) {
  constexpr size_t kMaxColor = 8;
  assert(color.size() <= kMaxColor);
  auto describe = [](const Attachment& attachment) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = attachment.image->layerView(attachment.layer);
    info.imageLayout = attachment.image->layout;
    info.loadOp = attachment.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = attachment.clearValue;
    return info;
  };
  std::array<VkRenderingAttachmentInfo, kMaxColor> colors;
  for (size_t i = 0; i < color.size(); ++i) {
    const VkImageLayout now = color[i].image->layout;
    if (now != VK_IMAGE_LAYOUT_GENERAL && now != VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL) {
      transition(*color[i].image, VK_IMAGE_LAYOUT_GENERAL);
    }
    colors[i] = describe(color[i]);
  }
  VkRenderingAttachmentInfo depthInfo{};
  if (depth != nullptr) {
    const VkImageLayout now = depth->image->layout;
    if (now != VK_IMAGE_LAYOUT_GENERAL && now != VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL) {
      transition(*depth->image, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    }
    depthInfo = describe(*depth);
  }
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea = {{0, 0}, extent};
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<uint32_t>(color.size());
  info.pColorAttachments = colors.data();
  info.pDepthAttachment = depth != nullptr ? &depthInfo : nullptr;
  vkCmdBeginRendering(commands_, &info);
  const VkViewport viewport{0.f, 0.f, static_cast<float>(extent.width), static_cast<float>(extent.height), 0.f, 1.f};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  vkCmdSetScissor(commands_, 0, 1, &info.renderArea);
}

void Commands::endRendering() { vkCmdEndRendering(commands_); }

}  // namespace radivox::gpu
