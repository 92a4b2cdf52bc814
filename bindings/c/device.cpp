#include "bindings/c/handles.h"
#include "engine/gpu/requirements.h"

using namespace radivox;
using c::guarded;

struct RadivoxNeeds {
  explicit RadivoxNeeds(VkPhysicalDevice physicalDevice) : requirements(physicalDevice) {}
  gpu::DeviceRequirements requirements;
};

RadivoxResult radivoxCreateNeeds(VkPhysicalDevice physicalDevice, RadivoxNeeds** needs) {
  return guarded([&] {
    c::require(needs, "needs");
    c::require(physicalDevice, "physicalDevice");
    auto made = std::make_unique<RadivoxNeeds>(physicalDevice);
    std::string lacking;
    for (const std::string& name : made->requirements.missing()) lacking += (lacking.empty() ? "" : ", ") + name;
    if (!lacking.empty()) throw Error(ErrorCode::Unsupported, "the device lacks " + lacking + "; use another");
    *needs = made.release();
  });
}

void radivoxDestroyNeeds(RadivoxNeeds* needs) { delete needs; }

const VkPhysicalDeviceFeatures2* radivoxNeededFeatures(const RadivoxNeeds* needs) {
  return needs == nullptr ? nullptr : needs->requirements.chain();
}

uint32_t radivoxNeededExtensionCount(const RadivoxNeeds* needs) {
  return needs == nullptr ? 0 : static_cast<uint32_t>(needs->requirements.extensions().size());
}

const char* const* radivoxNeededExtensions(const RadivoxNeeds* needs) {
  return needs == nullptr ? nullptr : needs->requirements.extensions().data();
}

uint32_t radivoxNeededQueueFamily(const RadivoxNeeds* needs) { return needs == nullptr ? 0 : needs->requirements.queueFamily(); }

RadivoxResult radivoxAdoptDevice(const RadivoxAdoptInfo* info, RadivoxDevice** device) {
  return guarded([&] {
    c::require(device, "device");
    const RadivoxAdoptInfo given = c::takeStruct(info, "info");
    gpu::AdoptInfo adopt;
    adopt.instance = &c::require(given.instance, "info->instance");
    adopt.physicalDevice = &c::require(given.physicalDevice, "info->physicalDevice");
    adopt.device = &c::require(given.device, "info->device");
    adopt.queue = &c::require(given.queue, "info->queue");
    adopt.queueFamily = given.queueFamily;
    for (uint32_t i = 0; i < given.extensionCount; ++i) {
      adopt.deviceExtensions.push_back(c::requireText((&c::require(given.extensions, "info->extensions"))[i], "info->extensions[i]"));
    }
    adopt.enabledFeatures = given.enabledFeatures;
    adopt.debugUtils = given.debugUtils != VK_FALSE;
    if (given.pipelineCacheFile != nullptr) adopt.pipelineCacheFile = given.pipelineCacheFile;
    *device = new RadivoxDevice{gpu::Device::adopt(adopt)};
  });
}

RadivoxResult radivoxCreateDevice(const RadivoxDeviceInfo* info, RadivoxDevice** device) {
  return guarded([&] {
    c::require(device, "device");
    gpu::DeviceOptions options;
    if (info != nullptr) {
      const RadivoxDeviceInfo given = c::takeStruct(info, "info");
      options.index = static_cast<int>(given.physicalDevice) - 1;
      options.validation = given.validation != VK_FALSE;
      if (given.pipelineCacheFile != nullptr) options.pipelineCacheFile = given.pipelineCacheFile;
    }
    *device = new RadivoxDevice{gpu::Device::create(options)};
  });
}

void radivoxDestroyDevice(RadivoxDevice* device) { delete device; }
