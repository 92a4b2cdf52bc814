// Buffers, and copies between them and the host.
#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/gpu/resources.h"
#include "engine/gpu/staging.h"

namespace radivox::gpu {

namespace {

constexpr VkBufferUsageFlags kBufferUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
    VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;

/// Sizes are rounded up to words: fills and shaders work on words.
VkBufferCreateInfo describeBuffer(const Device& device, const std::string& name, VkDeviceSize bytes) {
  const VkDeviceSize limit = device.capabilities().maxBufferSize;
  if (bytes > limit || bytes > limit - 3) {
    throw Error(ErrorCode::OutOfMemory, "buffer " + name + ": " + std::to_string(bytes) + " bytes, but " +
                                            device.capabilities().deviceName + " allows buffers of at most " + std::to_string(limit) +
                                            "; lower the resolution");
  }
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes == 0 ? 16 : (bytes + 3) / 4 * 4;
  info.usage = kBufferUsage;
  return info;
}

VkDeviceAddress queryAddress(const Device& device, VkBuffer buffer) {
  VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
  info.buffer = buffer;
  return vkGetBufferDeviceAddress(device.handle(), &info);
}

VkMemoryPropertyFlags flagsOf(MemoryKind kind) {
  switch (kind) {
    case MemoryKind::Upload:
      return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    case MemoryKind::ReadBack:
      return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    case MemoryKind::Device:
      break;
  }
  return VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
}

}  // namespace

Buffer::Buffer(Device& device, const std::string& name, VkDeviceSize bytes, MemoryKind kind)
    : device_(&device), bytes_(bytes == 0 ? 16 : bytes), name_(name) {
  const VkBufferCreateInfo info = describeBuffer(device, name, bytes);
  try {
    check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device.handle(), buffer_, &needs);
    ownedMemory_ = device.allocate(needs, flagsOf(kind), true);
    check(vkBindBufferMemory(device.handle(), buffer_, ownedMemory_, 0), "vkBindBufferMemory");
    if (kind != MemoryKind::Device) check(vkMapMemory(device.handle(), ownedMemory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
  } catch (const Error& error) {
    release();
    throw Error(error.code(), "buffer " + name + ": " + error.what());
  }
  address_ = queryAddress(device, buffer_);
  device.setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
}

Buffer::Buffer(Device& device, const std::string& name, VkDeviceSize bytes, VkDeviceMemory memory, VkDeviceSize offset)
    : device_(&device), bytes_(bytes == 0 ? 16 : bytes), name_(name) {
  const VkBufferCreateInfo info = describeBuffer(device, name, bytes);
  check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
  const VkResult bound = vkBindBufferMemory(device.handle(), buffer_, memory, offset);
  if (bound != VK_SUCCESS) release();
  check(bound, "vkBindBufferMemory");
  address_ = queryAddress(device, buffer_);
  device.setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
}

Buffer::Buffer(const std::string& name, VkBuffer buffer, VkDeviceSize bytes, VkDeviceAddress address)
    : buffer_(buffer), bytes_(bytes), address_(address), name_(name) {}

Buffer::Buffer(Buffer&& other) noexcept { *this = std::move(other); }

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
  texels_ = std::exchange(other.texels_, {});
  ownedMemory_ = std::exchange(other.ownedMemory_, VK_NULL_HANDLE);
  bytes_ = std::exchange(other.bytes_, 0);
  address_ = std::exchange(other.address_, 0);
  mapped_ = std::exchange(other.mapped_, nullptr);
  name_ = std::move(other.name_);
  return *this;
}

Buffer::~Buffer() { release(); }

void Buffer::release() noexcept {
  if (device_ == nullptr) return;
  for (VkBufferView view : texels_) vkDestroyBufferView(device_->handle(), view, nullptr);
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  device_->free(ownedMemory_);  // unmaps too
  texels_ = {};
  buffer_ = VK_NULL_HANDLE;
  ownedMemory_ = VK_NULL_HANDLE;
  mapped_ = nullptr;
  device_ = nullptr;
}

VkBufferView Buffer::texels(TexelType type) const {
  constexpr VkFormat kFormats[] = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_UINT, VK_FORMAT_R32G32B32A32_SINT};
  const VkFormat format = kFormats[static_cast<size_t>(type)];
  VkBufferView& view = texels_.at(static_cast<size_t>(type));
  if (view != VK_NULL_HANDLE) return view;
  if (device_ == nullptr) throw Error(ErrorCode::Unsupported, "buffer " + name_ + ": a host's buffer cannot be read as texels");
  const Capabilities& can = device_->capabilities();
  const VkDeviceSize size = texelBytes(format), count = ((bytes_ + 3) / 4 * 4) / size;
  if (count > can.maxTexelBufferElements) {
    throw Error(ErrorCode::OutOfMemory, "buffer " + name_ + ": " + std::to_string(count) + " texels, but " + can.deviceName +
                                            " reads at most " + std::to_string(can.maxTexelBufferElements) +
                                            " of a buffer; lower the resolution");
  }
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer_;
  info.format = format;
  info.range = count * size;
  check(vkCreateBufferView(device_->handle(), &info, nullptr, &view), "vkCreateBufferView");
  return view;
}

VkMemoryRequirements Buffer::requirements(Device& device, VkDeviceSize bytes) {
  const VkBufferCreateInfo info = describeBuffer(device, "of a transient resource", bytes);
  VkDeviceBufferMemoryRequirements query{VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS};
  query.pCreateInfo = &info;
  VkMemoryRequirements2 needs{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceBufferMemoryRequirements(device.handle(), &query, &needs);
  return needs.memoryRequirements;
}

void recordFullBarrier(VkCommandBuffer commands) {
  VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

void upload(Device& device, Buffer& to, std::span<const std::byte> data, VkDeviceSize offset) {
  if (offset > to.bytes() || data.size() > to.bytes() - offset) {
    throw Error(ErrorCode::BadInput, "upload of " + std::to_string(data.size()) + " bytes at " + std::to_string(offset) +
                                         " past the end of buffer " + to.name() + " of " + std::to_string(to.bytes()));
  }
  if (data.empty()) return;
  if (to.mapped() != nullptr) {
    std::memcpy(static_cast<std::byte*>(to.mapped()) + offset, data.data(), data.size());
    return;
  }
  Buffer staging(device, "upload staging", std::min<VkDeviceSize>(data.size(), kStagingBytes), MemoryKind::Upload);
  for (size_t done = 0; done < data.size();) {
    const size_t bytes = std::min<size_t>(data.size() - done, kStagingBytes);
    std::memcpy(staging.mapped(), data.data() + done, bytes);
    device.submitAndWait([&](VkCommandBuffer commands) {
      recordFullBarrier(commands);
      const VkBufferCopy region{0, offset + done, bytes};
      vkCmdCopyBuffer(commands, staging.handle(), to.handle(), 1, &region);
      recordFullBarrier(commands);
    });
    done += bytes;
  }
}

std::vector<std::byte> download(Device& device, const Buffer& from, VkDeviceSize offset, VkDeviceSize bytes) {
  if (bytes == VK_WHOLE_SIZE && offset <= from.bytes()) bytes = from.bytes() - offset;
  if (offset > from.bytes() || bytes > from.bytes() - offset) {
    throw Error(ErrorCode::BadInput, "download of " + std::to_string(bytes) + " bytes at " + std::to_string(offset) +
                                         " past the end of buffer " + from.name() + " of " + std::to_string(from.bytes()));
  }
  std::vector<std::byte> data(static_cast<size_t>(bytes));
  if (data.empty()) return data;
  if (from.mapped() != nullptr) {
    std::memcpy(data.data(), static_cast<const std::byte*>(from.mapped()) + offset, data.size());
    return data;
  }
  Buffer staging(device, "download staging", std::min<VkDeviceSize>(bytes, kStagingBytes), MemoryKind::ReadBack);
  for (size_t done = 0; done < data.size();) {
    const size_t piece = std::min<size_t>(data.size() - done, kStagingBytes);
    device.submitAndWait([&](VkCommandBuffer commands) {
      recordFullBarrier(commands);
      const VkBufferCopy region{offset + done, 0, piece};
      vkCmdCopyBuffer(commands, from.handle(), staging.handle(), 1, &region);
      recordFullBarrier(commands);
    });
    std::memcpy(data.data() + done, staging.mapped(), piece);
    done += piece;
  }
  return data;
}

}  // namespace radivox::gpu
