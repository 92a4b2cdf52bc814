#include "engine/gpu/device.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdio>

#include "engine/gpu/compile_pool.h"
#include "engine/gpu/device_builder.h"
#include "engine/gpu/host_memory.h"
#include "engine/gpu/pipeline_cache_file.h"

namespace radivox::gpu {

const char* printResult(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost (driver crash or time-out)";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "memory map failed";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "incompatible driver";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
      return "format not supported";
    case VK_ERROR_FRAGMENTED_POOL:
      return "fragmented pool";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "out of pool memory";
    case VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS:
      return "no device address left";
    default:
      return "unexpected result";
  }
}

void check(VkResult result, const char* call) {
  if (result >= VK_SUCCESS) return;
  const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                      result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL;
  throw Error(memory ? ErrorCode::OutOfMemory : ErrorCode::DeviceFailed,
              std::string(call) + ": " + printResult(result) + " (VkResult " + std::to_string(result) + ")");
}

namespace {

std::string printBytes(VkDeviceSize bytes) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
  return bytes < 1024 * 1024 ? std::to_string(bytes) + " B" : text;
}

struct CommandBufferGuard {
  VkDevice device;
  VkCommandPool pool;
  VkCommandBuffer commands;
  ~CommandBufferGuard() { vkFreeCommandBuffers(device, pool, 1, &commands); }
};

struct FenceGuard {
  VkDevice device;
  VkFence fence;
  ~FenceGuard() { vkDestroyFence(device, fence, nullptr); }
};

}  // namespace

Device::Device() : compilePool_(std::make_unique<CompilePool>()) {}

void Device::waitForPipelines() { compilePool_->finish(); }

Device::~Device() {
  compilePool_.reset();
  if (device_ != VK_NULL_HANDLE) {
    assert(allocations_.empty() && "a buffer or image outlives its device");
    if (pipelineCache_ != VK_NULL_HANDLE && !pipelineCacheFile_.empty()) {
      size_t bytes = 0;
      if (vkGetPipelineCacheData(device_, pipelineCache_, &bytes, nullptr) == VK_SUCCESS && bytes != pipelineCacheBytes_) {
        std::vector<std::byte> data(bytes);
        if (vkGetPipelineCacheData(device_, pipelineCache_, &bytes, data.data()) == VK_SUCCESS) {
          data.resize(bytes);
          VkPhysicalDeviceProperties properties{};
          vkGetPhysicalDeviceProperties(physicalDevice_, &properties);
          savePipelineCacheFile(pipelineCacheFile_, properties, data);
        }
      }
    }
    vkDestroyPipelineCache(device_, pipelineCache_, nullptr);
    vkDestroyCommandPool(device_, commandPool_, nullptr);
  }
  if (!ownsDevice_) return;
  if (device_ != VK_NULL_HANDLE) vkDestroyDevice(device_, nullptr);
  if (messenger_ != VK_NULL_HANDLE) {
    auto destroy =
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

bool Device::takeInjectedFailure() {
  if (failCountdown_ == 0) return false;
  return --failCountdown_ == 0;
}

VkDeviceMemory Device::allocate(const VkMemoryRequirements& requirements, VkMemoryPropertyFlags flags, bool deviceAddress) {
  const VkDeviceSize bytes = requirements.size;
  std::lock_guard lock(memoryMutex_);
  if (takeInjectedFailure()) throw Error(ErrorCode::OutOfMemory, "cannot allocate " + printBytes(bytes) + ": failure injected by a test");
  if (bytes > capabilities_.maxMemoryAllocationSize) {
    throw Error(ErrorCode::OutOfMemory, "cannot allocate " + printBytes(bytes) + " in one piece: " + capabilities_.deviceName +
                                            " allows at most " + printBytes(capabilities_.maxMemoryAllocationSize) +
                                            "; lower the resolution or the image size");
  }
  constexpr VkMemoryPropertyFlags kWishes = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  auto findType = [&](VkMemoryPropertyFlags wanted) -> uint32_t {
    for (uint32_t i = 0; i < memoryProperties_.memoryTypeCount; ++i) {
      const bool allowed = (requirements.memoryTypeBits >> i & 1u) != 0;
      if (allowed && (memoryProperties_.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    }
    return VK_MAX_MEMORY_TYPES;
  };
  uint32_t type = findType(flags);
  if (type == VK_MAX_MEMORY_TYPES) type = findType(flags & ~kWishes);
  if (type == VK_MAX_MEMORY_TYPES) {
    throw Error(ErrorCode::OutOfMemory, "no memory type of " + capabilities_.deviceName + " fits an allocation of " + printBytes(bytes));
  }
  const uint32_t heap = memoryProperties_.memoryTypes[type].heapIndex;
  const auto describe = [&] {
    return "cannot allocate " + printBytes(bytes) + " from memory heap " + std::to_string(heap) + " of " +
           printBytes(memoryProperties_.memoryHeaps[heap].size) + " (" + printBytes(memoryUse_.current) +
           " in use by Radivox); lower the resolution or the image size";
  };
  if (bytes > memoryProperties_.memoryHeaps[heap].size) throw Error(ErrorCode::OutOfMemory, describe());

  // Memory that was allocated but not touched yet still counts as available, hence the second test.
  if (hostBudget_ > 0 && (bytes > availableHostMemory() || memoryUse_.current + bytes > hostBudget_)) {
    throw Error(ErrorCode::OutOfMemory, "cannot allocate " + printBytes(bytes) + ": the machine has " + printBytes(hostBudget_) +
                                            " to spare and " + printBytes(memoryUse_.current) +
                                            " are in use by Radivox; lower the resolution or the image size");
  }

  VkMemoryAllocateFlagsInfo addressFlags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
  addressFlags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.pNext = deviceAddress ? &addressFlags : nullptr;
  info.allocationSize = bytes;
  info.memoryTypeIndex = type;
  allocations_.reserve(allocations_.size() + 1);  // so that nothing throws once the memory is ours
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device_, &info, nullptr, &memory);
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_TOO_MANY_OBJECTS) {
    throw Error(ErrorCode::OutOfMemory, describe());
  }
  check(result, "vkAllocateMemory");
  allocations_.emplace_back(memory, bytes);
  memoryUse_.current += bytes;
  memoryUse_.peak = std::max(memoryUse_.peak, memoryUse_.current);
  ++memoryUse_.allocationCount;
  return memory;
}

void Device::free(VkDeviceMemory memory) {
  if (memory == VK_NULL_HANDLE) return;
  std::lock_guard lock(memoryMutex_);
  const auto found = std::find_if(allocations_.begin(), allocations_.end(), [&](const auto& a) { return a.first == memory; });
  assert(found != allocations_.end() && "memory that this device did not allocate");
  memoryUse_.current -= found->second;
  --memoryUse_.allocationCount;
  *found = allocations_.back();
  allocations_.pop_back();
  vkFreeMemory(device_, memory, nullptr);
}

MemoryUse Device::memoryUse() const {
  std::lock_guard lock(memoryMutex_);
  return memoryUse_;
}

void Device::resetPeakMemory() {
  std::lock_guard lock(memoryMutex_);
  memoryUse_.peak = memoryUse_.current;
}

void Device::submitAndWait(const std::function<void(VkCommandBuffer)>& record) {
  VkCommandBufferAllocateInfo allocation{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocation.commandPool = commandPool_;
  allocation.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocation.commandBufferCount = 1;
  CommandBufferGuard guard{device_, commandPool_, VK_NULL_HANDLE};
  check(vkAllocateCommandBuffers(device_, &allocation, &guard.commands), "vkAllocateCommandBuffers");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(guard.commands, &begin), "vkBeginCommandBuffer");
  record(guard.commands);
  check(vkEndCommandBuffer(guard.commands), "vkEndCommandBuffer");
  submitAndWait(guard.commands);
}

void Device::submitAndWait(VkCommandBuffer commands) {
  if (takeInjectedFailure()) throw Error(ErrorCode::DeviceFailed, "vkQueueSubmit2: failure injected by a test");
  FenceGuard guard{device_, VK_NULL_HANDLE};
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device_, &fence, nullptr, &guard.fence), "vkCreateFence");
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  check(vkQueueSubmit2(queue_, 1, &submit, guard.fence), "vkQueueSubmit2");
  check(vkWaitForFences(device_, 1, &guard.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

void Device::setName(VkObjectType type, uint64_t handle, const std::string& name) const {
  if (setObjectName_ == nullptr || name.empty()) return;
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = name.c_str();
  setObjectName_(device_, &info);  // a name that cannot be kept is no error
}

}  // namespace radivox::gpu
