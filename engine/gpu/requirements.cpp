#include "engine/gpu/requirements.h"

#include <algorithm>

namespace radivox::gpu {

std::vector<std::string> listDeviceExtensions(VkPhysicalDevice physicalDevice) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physicalDevice, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> properties(count);
  vkEnumerateDeviceExtensionProperties(physicalDevice, nullptr, &count, properties.data());
  std::vector<std::string> names;
  for (const auto& p : properties) names.emplace_back(p.extensionName);
  return names;
}

DeviceRequirements::DeviceRequirements(VkPhysicalDevice physicalDevice, const Options& options) {
  features_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features11_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
  features12_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  features13_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
  features_.pNext = &features11_;
  features11_.pNext = &features12_;
  features12_.pNext = &features13_;

  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physicalDevice, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_3) {
    missing_.push_back("Vulkan 1.3 (has " + std::to_string(VK_API_VERSION_MAJOR(properties.apiVersion)) + "." +
                       std::to_string(VK_API_VERSION_MINOR(properties.apiVersion)) + ")");
    return;  // the structs below are unknown to it
  }

  VkPhysicalDeviceVulkan13Features has13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features has12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &has13};
  VkPhysicalDeviceVulkan11Features has11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, &has12};
  VkPhysicalDeviceFeatures2 has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has11};
  vkGetPhysicalDeviceFeatures2(physicalDevice, &has);

  auto require = [&](VkBool32 available, VkBool32& enable, const char* name) {
    enable = VK_TRUE;
    if (!available) missing_.emplace_back(name);
  };
  auto use = [](VkBool32 available, VkBool32& enable) { enable = available; };

  require(has13.dynamicRendering, features13_.dynamicRendering, "dynamicRendering");
  require(has13.synchronization2, features13_.synchronization2, "synchronization2");
  require(has13.maintenance4, features13_.maintenance4, "maintenance4");
  // glslang turns `discard` into OpTerminateInvocation or OpDemoteToHelperInvocation for Vulkan 1.3.
  require(has13.shaderTerminateInvocation, features13_.shaderTerminateInvocation, "shaderTerminateInvocation");
  require(has13.shaderDemoteToHelperInvocation, features13_.shaderDemoteToHelperInvocation, "shaderDemoteToHelperInvocation");
  require(has12.scalarBlockLayout, features12_.scalarBlockLayout, "scalarBlockLayout");
  require(has12.bufferDeviceAddress, features12_.bufferDeviceAddress, "bufferDeviceAddress");
  require(has12.hostQueryReset, features12_.hostQueryReset, "hostQueryReset");
  require(has.features.fragmentStoresAndAtomics, features_.features.fragmentStoresAndAtomics, "fragmentStoresAndAtomics");

  VkPhysicalDeviceFeatures& f = features_.features;
  use(has.features.geometryShader, f.geometryShader);
  use(has.features.shaderInt64, f.shaderInt64);
  use(has.features.vertexPipelineStoresAndAtomics, f.vertexPipelineStoresAndAtomics);
  use(has.features.depthClamp, f.depthClamp);
  use(has.features.independentBlend, f.independentBlend);
  use(has.features.shaderStorageImageReadWithoutFormat, f.shaderStorageImageReadWithoutFormat);
  use(has.features.shaderStorageImageWriteWithoutFormat, f.shaderStorageImageWriteWithoutFormat);
  use(has.features.shaderStorageImageExtendedFormats, f.shaderStorageImageExtendedFormats);
  use(has11.shaderDrawParameters, features11_.shaderDrawParameters);
  use(has12.shaderOutputLayer, features12_.shaderOutputLayer);

  uint32_t familyCount = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &familyCount, nullptr);
  std::vector<VkQueueFamilyProperties> families(familyCount);
  vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &familyCount, families.data());
  constexpr VkQueueFlags kWanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < familyCount && queueFamily_ == ~0u; ++i) {
    if ((families[i].queueFlags & kWanted) == kWanted) queueFamily_ = i;
  }
  if (queueFamily_ == ~0u) missing_.emplace_back("a queue with graphics and compute");

  const auto names = listDeviceExtensions(physicalDevice);
  auto offers = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (options.pushDescriptors && offers(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) {
    extensions_.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
  }
  if (options.conservativeRasterization && offers(VK_EXT_CONSERVATIVE_RASTERIZATION_EXTENSION_NAME)) {
    extensions_.push_back(VK_EXT_CONSERVATIVE_RASTERIZATION_EXTENSION_NAME);
  }
}

}  // namespace radivox::gpu
