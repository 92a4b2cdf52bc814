// The Vulkan device: our own, or a host's that we adopt. Owns no window, no globals.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/error.h"

namespace radivox::gpu {

class CompilePool;

/// Throws Error(OutOfMemory / DeviceFailed) naming the call when `result` is an error.
void check(VkResult result, const char* call);

/// What the device can do, decided once at start; reported by `radivox info`. Optional features are used where true.
struct Capabilities {
  std::string deviceName;
  std::string driverName;
  std::string driverInfo;
  uint32_t apiVersion = 0;
  VkPhysicalDeviceType deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  bool conservativeRasterization = false;  ///< VK_EXT_conservative_rasterization (overestimate)
  bool geometryShader = false;
  bool pushDescriptor = false;  ///< VK_KHR_push_descriptor; a descriptor pool is used otherwise
  bool int64Atomics = false;    ///< reported only; sums use pairs of 32-bit words, which every device has
  bool rayQuery = false;        ///< reported only, so far
  bool debugUtils = false;
  uint32_t subgroupSize = 0;
  float timestampPeriodNs = 0.f;  ///< 0: no timestamps
  VkDeviceSize maxStorageBufferRange = 0;
  uint32_t maxTexelBufferElements = 0;  ///< of a TexelBuffer
  VkDeviceSize maxBufferSize = 0;
  VkDeviceSize deviceLocalBytes = 0;
  uint32_t maxImageDimension2D = 0;
  uint32_t maxImageArrayLayers = 0;
  uint32_t maxComputeWorkGroupCount = 0;  ///< along x
  VkDeviceSize maxUniformBufferRange = 0;
  VkDeviceSize maxMemoryAllocationSize = 0;
  VkDeviceSize storageOffsetAlignment = 0;  ///< of BoundResource::offset
  bool depthClamp = false;
  bool layerFromVertexShader = false;  ///< gl_Layer may be written without a geometry shader
  uint32_t timestampValidBits = 0;
};

struct DeviceOptions {
  int index = -1;                                     ///< physical device; −1: the best (discrete, integrated, virtual, CPU)
  bool validation = false;                            ///< Khronos layer with synchronization validation; messages go to `onMessage`
  std::string pipelineCacheFile;                      ///< empty: none. Written to a temporary name and renamed when the device closes
  bool pushDescriptors = true;                        ///< false forces the descriptor-pool fallback (tests)
  bool conservativeRasterization = true;              ///< false hides the hardware extension (tests)
  std::function<void(const std::string&)> onMessage;  ///< validation messages; default: stderr and count
  std::vector<std::string> instanceExtensions;        ///< more to enable, for a host that shows windows; Unsupported where they are not
  std::vector<std::string> deviceExtensions;          ///< likewise
};

/// Handles of a host's device. The host keeps ownership and must have enabled what DeviceRequirements (requirements.h) asks for.
/// While Radivox uploads, downloads, or runs its own command buffers, the host leaves the queue alone.
struct AdoptInfo {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< graphics + compute
  uint32_t queueFamily = 0;
  std::vector<std::string> deviceExtensions;  ///< those the host enabled
  /// The feature chain the host gave to vkCreateDevice. Null: the chain of DeviceRequirements as it stands.
  const VkPhysicalDeviceFeatures2* enabledFeatures = nullptr;
  bool debugUtils = false;  ///< the host enabled VK_EXT_debug_utils, so that objects may be named
  std::string pipelineCacheFile;
};

/// Bytes by what they are for. "Memory reported is memory allocated": every vkAllocateMemory goes through Device.
struct MemoryUse {
  VkDeviceSize current = 0;
  VkDeviceSize peak = 0;
  uint32_t allocationCount = 0;
};

class Device {
 public:
  static std::unique_ptr<Device> create(const DeviceOptions& options = {});  ///< throws Unsupported when no device fits
  static std::unique_ptr<Device> adopt(const AdoptInfo& info);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physicalDevice() const { return physicalDevice_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  uint32_t queueFamily() const { return queueFamily_; }
  VkPipelineCache pipelineCache() const { return pipelineCache_; }
  CompilePool& compilePool() { return *compilePool_; }
  /// Until all compute pipelines that were asked for are compiled and the threads that did it have ended; errors are thrown where a pipeline is used.
  void waitForPipelines();
  const Capabilities& capabilities() const { return capabilities_; }
  uint32_t validationMessageCount() const { return validationMessageCount_; }

  /// One allocation per call (Radivox has tens of resources, not thousands). Throws OutOfMemory with the size. HOST_VISIBLE and
  /// HOST_COHERENT are demands; DEVICE_LOCAL and HOST_CACHED are wishes, dropped where no memory type grants them.
  VkDeviceMemory allocate(const VkMemoryRequirements& requirements, VkMemoryPropertyFlags flags, bool deviceAddress);
  void free(VkDeviceMemory memory);
  MemoryUse memoryUse() const;
  /// Peak starts anew at the current use.
  void resetPeakMemory();

  /// Test hook: the n-th allocation or submission from now on fails (0: never). Counts down at each call.
  void failAfter(uint32_t n) { failCountdown_ = n; }
  bool takeInjectedFailure();

  /// Not thread-safe: one thread at a time records and submits on a Device.
  /// Records `record` into a fresh command buffer, submits, waits. For uploads, read-back and tests.
  void submitAndWait(const std::function<void(VkCommandBuffer)>& record);
  /// Submits an already recorded command buffer and waits for it.
  void submitAndWait(VkCommandBuffer commands);
  VkCommandPool commandPool() const { return commandPool_; }

  /// Debug name, where VK_EXT_debug_utils is there.
  void setName(VkObjectType type, uint64_t handle, const std::string& name) const;

  // VK_KHR_push_descriptor entry point; null without the extension.
  PFN_vkCmdPushDescriptorSetKHR cmdPushDescriptorSet = nullptr;

 private:
  Device();
  friend struct DeviceBuilder;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  uint32_t queueFamily_ = 0;
  VkPipelineCache pipelineCache_ = VK_NULL_HANDLE;
  std::unique_ptr<CompilePool> compilePool_;
  VkCommandPool commandPool_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  PFN_vkSetDebugUtilsObjectNameEXT setObjectName_ = nullptr;
  bool ownsDevice_ = false;
  std::string pipelineCacheFile_;
  size_t pipelineCacheBytes_ = 0;  ///< as loaded; written again only when it has grown or shrunk
  Capabilities capabilities_;
  VkPhysicalDeviceMemoryProperties memoryProperties_{};
  mutable std::mutex memoryMutex_;
  MemoryUse memoryUse_;
  uint64_t hostBudget_ = 0;  ///< CPU devices: what the machine had available at the start; 0: not a CPU device
  std::vector<std::pair<VkDeviceMemory, VkDeviceSize>> allocations_;
  uint32_t failCountdown_ = 0;
  std::atomic<uint32_t> validationMessageCount_{0};  ///< the layer calls from any thread
  std::function<void(const std::string&)> onMessage_;
};

}  // namespace radivox::gpu
