// A thin recorder over a VkCommandBuffer (ours or a host's): bind, push, dispatch, draw, barrier. Allocates nothing on the
// push-descriptor path; the fallback takes sets from a pool that grows by 1024 when empty.
#pragma once

#include <array>
#include <type_traits>
#include <variant>

#include "engine/gpu/pipeline.h"

namespace radivox::gpu {

/// Sets for devices without push descriptors, and the shared nearest sampler. One per executor; reset once its work is done.
class DescriptorPool {
 public:
  explicit DescriptorPool(Device& device);
  ~DescriptorPool();
  DescriptorPool(const DescriptorPool&) = delete;
  DescriptorPool& operator=(const DescriptorPool&) = delete;
  VkDescriptorSet take(const Pipeline& pipeline);  ///< grows by a pool of 1024 sets when empty
  void reset();
  VkSampler nearestSampler() const { return sampler_; }
  /// What null resources are bound to: zeros, never read or written by a shader that keeps its word.
  const Buffer& placeholder() const { return placeholderBuffer_; }
  const Image& placeholder(ImageKind kind) const;

 private:
  Device& device_;
  std::vector<VkDescriptorPool> pools_;
  size_t current_ = 0;
  VkSampler sampler_ = VK_NULL_HANDLE;
  Buffer placeholderBuffer_;
  std::array<Image, 6> placeholderImages_;  ///< TexelType × (2D, 2D array)
};

/// What goes into one binding. Offsets are multiples of 256. A null buffer or image is allowed only where the shader never reads it.
struct BoundResource {
  BoundResource(const Buffer& b) : buffer(&b) {}  // NOLINT: implicit on purpose, so that lists of bindings read plainly
  BoundResource(const Image& i) : image(&i) {}    // NOLINT
  BoundResource(const Buffer& b, VkDeviceSize offset_, VkDeviceSize range_) : buffer(&b), offset(offset_), range(range_) {}
  const Buffer* buffer = nullptr;
  const Image* image = nullptr;
  VkDeviceSize offset = 0;
  VkDeviceSize range = VK_WHOLE_SIZE;
};

class Commands {
 public:
  Commands(Device& device, VkCommandBuffer commands, DescriptorPool& pool) : device_(device), commands_(commands), pool_(pool) {}
  VkCommandBuffer handle() const { return commands_; }
  Device& device() const { return device_; }

  void bind(const Pipeline& pipeline, std::initializer_list<BoundResource> resources);
  void bind(const Pipeline& pipeline, std::span<const BoundResource> resources);
  template <class T>
  void push(const T& constants) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 128);
    pushBytes(&constants, sizeof(T));
  }
  void dispatch(uint32_t groupsX, uint32_t groupsY = 1, uint32_t groupsZ = 1);
  /// Enough groups of `groupSize` for `itemCount`, folded into rows of at most kMaxGroupsX groups along y. The shader finds its
  /// item with radivoxItemIndex() of shaders/shared/dispatch.glsl and must test it against the count. 0 items: nothing recorded.
  void dispatchItems(uint64_t itemCount, uint32_t groupSize);
  void dispatchIndirect(const Buffer& arguments, VkDeviceSize offset = 0);
  void draw(uint32_t vertexCount, uint32_t instanceCount = 1);

  void fill(const Buffer& buffer, uint32_t value, VkDeviceSize offset = 0, VkDeviceSize bytes = VK_WHOLE_SIZE);
  void update(const Buffer& buffer, const void* data, VkDeviceSize bytes, VkDeviceSize offset = 0);  ///< ≤ 65536 bytes
  void copy(const Buffer& from, const Buffer& to, VkDeviceSize bytes, VkDeviceSize fromOffset = 0, VkDeviceSize toOffset = 0);

  /// All earlier shader, transfer, and attachment writes are seen by all later commands. For steps inside a node; between nodes the
  /// graph places narrower barriers.
  void barrier();
  void transition(Image& image, VkImageLayout to);  ///< full barrier; UNDEFINED contents are lost

  struct Attachment {
    Image* image = nullptr;
    uint32_t layer = 0;
    bool clear = true;
    VkClearValue clearValue{};
  };
  /// Dynamic rendering with viewport and scissor set to the extent (y down, as Vulkan has it). Without attachments the extent alone
  /// decides which pixels are covered. Colour images come to layout GENERAL, depth images to DEPTH_ATTACHMENT_OPTIMAL, unless they
  /// are in a layout that can be rendered to already.
  void beginRendering(VkExtent2D extent, std::span<const Attachment> color, const Attachment* depth);
  void endRendering();
  /// Inside rendering: viewport and scissor of a tile, in texels.
  void setViewport(int32_t x, int32_t y, uint32_t width, uint32_t height) {
    const VkViewport viewport{
        static_cast<float>(x), static_cast<float>(y), static_cast<float>(width), static_cast<float>(height), 0.f, 1.f};
    const VkRect2D scissor{{x, y}, {width, height}};
    vkCmdSetViewport(commands_, 0, 1, &viewport);
    vkCmdSetScissor(commands_, 0, 1, &scissor);
  }
  /// Inside rendering: the scissor alone, which the attachment holds.
  void setScissor(const VkRect2D& scissor) { vkCmdSetScissor(commands_, 0, 1, &scissor); }

  static constexpr uint32_t kMaxGroupsX = 32768;

 private:
  void pushBytes(const void* data, uint32_t bytes);
  Device& device_;
  VkCommandBuffer commands_;
  DescriptorPool& pool_;
  const Pipeline* bound_ = nullptr;
};

}  // namespace radivox::gpu
