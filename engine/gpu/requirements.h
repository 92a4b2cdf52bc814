// What Radivox asks of a VkDevice: the features and extensions to enable. For our own devices, and for hosts that lend us theirs:
//
//   gpu::DeviceRequirements requirements(physicalDevice);
//   if (!requirements.missing().empty()) …                        // this device cannot run Radivox, and why
//   deviceInfo.pNext = requirements.chain();                       // or set the same bits in your own chain
//   deviceInfo.ppEnabledExtensionNames = requirements.extensions().data();
#pragma once

#include <vulkan/vulkan.h>

#include <string>
#include <vector>

namespace radivox::gpu {

class DeviceRequirements {
 public:
  struct Options {
    bool pushDescriptors = true;            ///< use VK_KHR_push_descriptor where it is there
    bool conservativeRasterization = true;  ///< use VK_EXT_conservative_rasterization where it is there
  };
  /// Queries the device; needs Vulkan 1.3 of it. Never throws for a weak device: see missing().
  explicit DeviceRequirements(VkPhysicalDevice physicalDevice) : DeviceRequirements(physicalDevice, Options{}) {}
  DeviceRequirements(VkPhysicalDevice physicalDevice, const Options& options);
  DeviceRequirements(const DeviceRequirements&) = delete;  // the chain points into itself
  DeviceRequirements& operator=(const DeviceRequirements&) = delete;

  /// Required features and limits the device lacks, by their Vulkan names. Empty: fit.
  const std::vector<std::string>& missing() const { return missing_; }
  /// Features to enable: all required ones, and those optional ones that the device has and Radivox uses.
  const VkPhysicalDeviceFeatures2* chain() const { return &features_; }
  const std::vector<const char*>& extensions() const { return extensions_; }
  /// The family to make a queue of: graphics and compute. Vulkan's ~0u when there is none (then it is in missing() too).
  uint32_t queueFamily() const { return queueFamily_; }

 private:
  VkPhysicalDeviceFeatures2 features_{};
  VkPhysicalDeviceVulkan11Features features11_{};
  VkPhysicalDeviceVulkan12Features features12_{};
  VkPhysicalDeviceVulkan13Features features13_{};
  std::vector<const char*> extensions_;
  std::vector<std::string> missing_;
  uint32_t queueFamily_ = ~0u;
};

/// Names of the extensions the device offers.
std::vector<std::string> listDeviceExtensions(VkPhysicalDevice physicalDevice);

}  // namespace radivox::gpu
