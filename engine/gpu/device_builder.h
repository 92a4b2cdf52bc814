// Private to engine/gpu: the steps that make a Device. device_create.cpp holds them, device.cpp the life after.
#pragma once

#include "engine/gpu/device.h"
#include "engine/gpu/requirements.h"

namespace radivox::gpu {

/// "VK_ERROR_DEVICE_LOST" and so on.
const char* printResult(VkResult result);

struct DeviceBuilder {
  std::unique_ptr<Device> device{new Device()};

  void makeInstance(const DeviceOptions& options);
  void choosePhysicalDevice(const DeviceOptions& options);
  void makeDevice(const DeviceOptions& options);
  /// Fills capabilities from the device, its enabled extensions and features.
  void readCapabilities(const std::vector<std::string>& enabledExtensions, const VkPhysicalDeviceFeatures2& enabled);
  /// Command pool, pipeline cache, entry points: what own and adopted devices share.
  void finish(const std::string& pipelineCacheFile);
};

}  // namespace radivox::gpu
