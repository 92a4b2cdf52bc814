// Makes or adopts a device. Everything that can be wrong with a machine is found here and said in one line.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "engine/gpu/device_builder.h"
#include "engine/gpu/host_memory.h"
#include "engine/gpu/pipeline_cache_file.h"

namespace radivox::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool offersLayer(const char* name) {
  uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

bool offersInstanceExtension(const char* layer, const char* name) {
  uint32_t count = 0;
  if (vkEnumerateInstanceExtensionProperties(layer, &count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkExtensionProperties> extensions(count);
  if (vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data()) < VK_SUCCESS) return false;
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

struct MessageSink {
  std::atomic<uint32_t>* count;
  const std::function<void(const std::string&)>* onMessage;
};

void deliver(const MessageSink& sink, const char* text) {
  sink.count->fetch_add(1);
  if (*sink.onMessage) {
    (*sink.onMessage)(text);
  } else {
    std::fprintf(stderr, "%s\n", text);
  }
}

std::string printVersion(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

std::string join(const std::vector<std::string>& parts) {
  std::string text;
  for (const auto& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

int rankType(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 1;
    default:
      return 0;
  }
}

bool contains(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The struct of a type in a host's feature chain, or null.
template <class T>
const T* findInChain(const void* chain, VkStructureType type) {
  for (auto* link = static_cast<const VkBaseInStructure*>(chain); link != nullptr; link = link->pNext) {
    if (link->sType == type) return reinterpret_cast<const T*>(link);
  }
  return nullptr;
}

}  // namespace

void DeviceBuilder::makeInstance(const DeviceOptions& options) {
  Device& d = *device;
  d.onMessage_ = options.onMessage;
  uint32_t version = 0;
  if (vkEnumerateInstanceVersion(&version) != VK_SUCCESS || version < VK_API_VERSION_1_3) {
    throw Error(ErrorCode::Unsupported,
                "the Vulkan loader is version " + printVersion(version) + "; Radivox needs 1.3: update libvulkan1 and the driver");
  }

  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  const bool debugUtils = offersInstanceExtension(nullptr, VK_EXT_DEBUG_UTILS_EXTENSION_NAME) ||
                          (options.validation && offersInstanceExtension(kValidationLayer, VK_EXT_DEBUG_UTILS_EXTENSION_NAME));
  if (options.validation) {
    if (!offersLayer(kValidationLayer)) {
      throw Error(ErrorCode::Unsupported, std::string("validation was asked for but ") + kValidationLayer +
                                              " is not installed; install vulkan-validationlayers or turn validation off");
    }
    if (!debugUtils || !offersInstanceExtension(kValidationLayer, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME)) {
      throw Error(ErrorCode::Unsupported,
                  "the installed validation layer lacks VK_EXT_validation_features or VK_EXT_debug_utils; update vulkan-validationlayers");
    }
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  if (debugUtils) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  d.capabilities_.debugUtils = debugUtils;
  for (const std::string& name : options.instanceExtensions) {
    if (!offersInstanceExtension(nullptr, name.c_str()))
      throw Error(ErrorCode::Unsupported, "the Vulkan loader lacks " + name + "; update libvulkan1 and the driver");
    extensions.push_back(name.c_str());
  }

  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT validation{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  validation.enabledValidationFeatureCount = 1;
  validation.pEnabledValidationFeatures = enabled;

  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = [](VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                 const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) -> VkBool32 {
    auto* self = static_cast<Device*>(user);
    deliver({&self->validationMessageCount_, &self->onMessage_}, data->pMessage);
    return VK_FALSE;
  };
  messenger.pUserData = device.get();

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "radivox";
  application.pEngineName = "radivox";
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  info.enabledLayerCount = static_cast<uint32_t>(layers.size());
  info.ppEnabledLayerNames = layers.data();
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  if (options.validation) {
    // Chained, the messenger hears vkCreateInstance and vkDestroyInstance too.
    validation.pNext = &messenger;
    info.pNext = &validation;
  }
  const VkResult result = vkCreateInstance(&info, nullptr, &d.instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw Error(
        ErrorCode::Unsupported,
        "no Vulkan device found; install mesa-vulkan-drivers or your GPU vendor's driver (`vulkaninfo --summary` lists what is there)");
  }
  check(result, "vkCreateInstance");
  d.ownsDevice_ = true;

  if (options.validation) {
    messenger.pNext = nullptr;
    auto create =
        reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(d.instance_, "vkCreateDebugUtilsMessengerEXT"));
    check(create(d.instance_, &messenger, nullptr, &d.messenger_), "vkCreateDebugUtilsMessengerEXT");
  }
}

void DeviceBuilder::choosePhysicalDevice(const DeviceOptions& options) {
  uint32_t count = 0;
  const VkResult result = vkEnumeratePhysicalDevices(device->instance_, &count, nullptr);
  if (result == VK_ERROR_INITIALIZATION_FAILED) count = 0;  // some loaders say so when no driver answers
  std::vector<VkPhysicalDevice> devices(count);
  if (count > 0) check(vkEnumeratePhysicalDevices(device->instance_, &count, devices.data()), "vkEnumeratePhysicalDevices");
  if (count == 0) {
    throw Error(
        ErrorCode::Unsupported,
        "no Vulkan device found; install mesa-vulkan-drivers or your GPU vendor's driver (`vulkaninfo --summary` lists what is there)");
  }
  std::vector<std::string> names;
  std::vector<std::string> faults;
  int best = -1;
  int bestRank = -1;
  for (uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    names.push_back(std::to_string(i) + ": " + properties.deviceName);
    const DeviceRequirements requirements(devices[i]);
    if (!requirements.missing().empty()) {
      faults.push_back(names.back() + " lacks " + join(requirements.missing()));
      if (options.index == static_cast<int>(i)) throw Error(ErrorCode::Unsupported, "device " + faults.back() + "; choose another device");
      continue;
    }
    if (rankType(properties.deviceType) > bestRank) {
      bestRank = rankType(properties.deviceType);
      best = static_cast<int>(i);
    }
  }
  if (options.index < -1 || options.index >= static_cast<int>(count)) {
    throw Error(ErrorCode::Unsupported,
                "there is no Vulkan device " + std::to_string(options.index) + "; choose one of " + join(names) + ", or -1 for the best");
  }
  if (best < 0) throw Error(ErrorCode::Unsupported, "no Vulkan device can run Radivox: " + join(faults) + "; update the driver");
  device->physicalDevice_ = devices[static_cast<size_t>(options.index < 0 ? best : options.index)];
}

void DeviceBuilder::makeDevice(const DeviceOptions& options) {
  Device& d = *device;
  const DeviceRequirements requirements(d.physicalDevice_, {options.pushDescriptors, options.conservativeRasterization});
  d.queueFamily_ = requirements.queueFamily();
  const float priority = 1.f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = d.queueFamily_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, requirements.chain()};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  std::vector<const char*> extensions = requirements.extensions();
  const std::vector<std::string> offered = listDeviceExtensions(d.physicalDevice_);
  for (const std::string& name : options.deviceExtensions) {
    if (!contains(offered, name.c_str())) throw Error(ErrorCode::Unsupported, "the device lacks " + name + "; choose another device");
    extensions.push_back(name.c_str());
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(d.physicalDevice_, &info, nullptr, &d.device_), "vkCreateDevice");
  vkGetDeviceQueue(d.device_, d.queueFamily_, 0, &d.queue_);
  readCapabilities({extensions.begin(), extensions.end()}, *requirements.chain());
}

void DeviceBuilder::readCapabilities(const std::vector<std::string>& enabledExtensions, const VkPhysicalDeviceFeatures2& enabled) {
  Device& d = *device;
  Capabilities& c = d.capabilities_;
  VkPhysicalDeviceMaintenance4Properties maintenance4{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  VkPhysicalDeviceMaintenance3Properties maintenance3{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES, &maintenance4};
  VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, &maintenance3};
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, &subgroup};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
  vkGetPhysicalDeviceProperties2(d.physicalDevice_, &properties);
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  c.deviceName = properties.properties.deviceName;
  c.driverName = driver.driverName;
  c.driverInfo = driver.driverInfo;
  c.apiVersion = properties.properties.apiVersion;
  c.deviceType = properties.properties.deviceType;
  c.subgroupSize = subgroup.subgroupSize;
  c.maxStorageBufferRange = limits.maxStorageBufferRange;
  c.maxTexelBufferElements = limits.maxTexelBufferElements;
  c.maxUniformBufferRange = limits.maxUniformBufferRange;
  c.maxBufferSize = maintenance4.maxBufferSize;
  c.maxMemoryAllocationSize = maintenance3.maxMemoryAllocationSize;
  c.storageOffsetAlignment = limits.minStorageBufferOffsetAlignment;
  c.maxImageDimension2D = limits.maxImageDimension2D;
  c.maxImageArrayLayers = limits.maxImageArrayLayers;
  c.maxComputeWorkGroupCount = limits.maxComputeWorkGroupCount[0];

  uint32_t familyCount = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(d.physicalDevice_, &familyCount, nullptr);
  std::vector<VkQueueFamilyProperties> families(familyCount);
  vkGetPhysicalDeviceQueueFamilyProperties(d.physicalDevice_, &familyCount, families.data());
  if (d.queueFamily_ < familyCount) c.timestampValidBits = families[d.queueFamily_].timestampValidBits;
  c.timestampPeriodNs = c.timestampValidBits > 0 ? limits.timestampPeriod : 0.f;

  vkGetPhysicalDeviceMemoryProperties(d.physicalDevice_, &d.memoryProperties_);
  for (uint32_t i = 0; i < d.memoryProperties_.memoryHeapCount; ++i) {
    const VkMemoryHeap& heap = d.memoryProperties_.memoryHeaps[i];
    if ((heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0) c.deviceLocalBytes = std::max(c.deviceLocalBytes, heap.size);
  }

  if (c.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) d.hostBudget_ = availableHostMemory();

  c.geometryShader = enabled.features.geometryShader == VK_TRUE;
  c.depthClamp = enabled.features.depthClamp == VK_TRUE;
  if (auto* f = findInChain<VkPhysicalDeviceVulkan12Features>(enabled.pNext, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)) {
    c.layerFromVertexShader = f->shaderOutputLayer == VK_TRUE;
  }
  c.pushDescriptor = contains(enabledExtensions, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
  c.conservativeRasterization = contains(enabledExtensions, VK_EXT_CONSERVATIVE_RASTERIZATION_EXTENSION_NAME);

  // Reported only: what the device has, whether enabled or not.
  VkPhysicalDeviceVulkan12Features has12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has12};
  vkGetPhysicalDeviceFeatures2(d.physicalDevice_, &has);
  c.int64Atomics = has12.shaderBufferInt64Atomics == VK_TRUE;
  c.rayQuery = contains(listDeviceExtensions(d.physicalDevice_), VK_KHR_RAY_QUERY_EXTENSION_NAME);
}

void DeviceBuilder::finish(const std::string& pipelineCacheFile) {
  Device& d = *device;
  if (d.capabilities_.pushDescriptor) {
    d.cmdPushDescriptorSet = reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(vkGetDeviceProcAddr(d.device_, "vkCmdPushDescriptorSetKHR"));
    d.capabilities_.pushDescriptor = d.cmdPushDescriptorSet != nullptr;
  }
  if (d.capabilities_.debugUtils) {
    d.setObjectName_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(vkGetDeviceProcAddr(d.device_, "vkSetDebugUtilsObjectNameEXT"));
  }
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = d.queueFamily_;
  check(vkCreateCommandPool(d.device_, &pool, nullptr, &d.commandPool_), "vkCreateCommandPool");

  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(d.physicalDevice_, &properties);
  d.pipelineCacheFile_ = pipelineCacheFile;
  std::vector<std::byte> data;
  if (!pipelineCacheFile.empty()) data = loadPipelineCacheFile(pipelineCacheFile, properties);
  d.pipelineCacheBytes_ = data.size();
  VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  cache.initialDataSize = data.size();
  cache.pInitialData = data.empty() ? nullptr : data.data();
  check(vkCreatePipelineCache(d.device_, &cache, nullptr, &d.pipelineCache_), "vkCreatePipelineCache");
}

std::unique_ptr<Device> Device::create(const DeviceOptions& options) {
  DeviceBuilder builder;
  builder.makeInstance(options);
  builder.choosePhysicalDevice(options);
  builder.makeDevice(options);
  builder.finish(options.pipelineCacheFile);
  return std::move(builder.device);
}

std::unique_ptr<Device> Device::adopt(const AdoptInfo& info) {
  if (info.instance == VK_NULL_HANDLE || info.physicalDevice == VK_NULL_HANDLE || info.device == VK_NULL_HANDLE ||
      info.queue == VK_NULL_HANDLE) {
    throw Error(ErrorCode::BadInput, "Device::adopt: instance, physical device, device and queue must all be given");
  }
  const DeviceRequirements requirements(info.physicalDevice);
  if (!requirements.missing().empty()) {
    throw Error(ErrorCode::Unsupported, "Device::adopt: the device lacks " + join(requirements.missing()));
  }
  DeviceBuilder builder;
  Device& d = *builder.device;
  d.instance_ = info.instance;
  d.physicalDevice_ = info.physicalDevice;
  d.device_ = info.device;
  d.queue_ = info.queue;
  d.queueFamily_ = info.queueFamily;
  d.capabilities_.debugUtils = info.debugUtils;
  builder.readCapabilities(info.deviceExtensions, info.enabledFeatures != nullptr ? *info.enabledFeatures : *requirements.chain());
  builder.finish(info.pipelineCacheFile);
  return std::move(builder.device);
}

}  // namespace radivox::gpu
