// What any host has before it meets Radivox: an instance, a device, a queue, a command buffer, images, buffers. Nothing here knows of
// Radivox: what its device must enable comes in from outside.
#pragma once

#include <vulkan/vulkan.h>

#include <functional>
#include <vector>

struct DeviceWishes {
  const VkPhysicalDeviceFeatures2* features = nullptr;
  std::vector<const char*> extensions;
  uint32_t queueFamily = 0;
};

struct HostImage {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
};

struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  void* mapped = nullptr;
  VkDeviceAddress address = 0;
};

class Host {
 public:
  /// `wishes` is asked once a physical device is chosen. Throws std::runtime_error naming the call that failed.
  Host(uint32_t width, uint32_t height, const std::function<DeviceWishes(VkPhysicalDevice)>& wishes);
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  HostImage makeImage(VkFormat format, VkImageUsageFlags usage);  ///< of the window's size
  HostBuffer makeBuffer(VkDeviceSize bytes, VkBufferUsageFlags usage);
  VkCommandBuffer beginCommands();
  void submitAndWait();  ///< what beginCommands() began

  const uint32_t width, height;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;

 private:
  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags);
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  std::vector<HostImage> images_;
  std::vector<HostBuffer> buffers_;
};

void check(VkResult result, const char* call);
