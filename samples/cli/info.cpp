// radivox info: what this machine and this build can do.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "engine/gpu/requirements.h"
#include "engine/graph/node.h"
#include "engine/scene/builtin.h"
#include "samples/cli/assets.h"
#include "samples/cli/describe.h"
#include "samples/cli/job.h"

namespace radivox::cli {

namespace {

std::string printVersion(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

std::string printBytes(VkDeviceSize bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / 1048576.0);
  return text;
}

const char* printType(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "CPU";
    default:
      return "other";
  }
}

void printFeature(const char* name, bool there, const char* use, const char* fallback) {
  std::cout << "      " << name << ": " << (there ? use : fallback) << "\n";
}

void printCapabilities(const gpu::Capabilities& c) {
  std::cout << "    driver: " << c.driverName << " " << c.driverInfo << "\n"
            << "    memory: " << printBytes(c.deviceLocalBytes) << ", buffers up to " << printBytes(c.maxBufferSize)
            << ", storage bindings up to " << printBytes(c.maxStorageBufferRange) << "\n"
            << "    images: up to " << c.maxImageDimension2D << " pixels a side, " << c.maxImageArrayLayers << " layers\n"
            << "    subgroups of " << c.subgroupSize << "\n"
            << "    optional features:\n";
  printFeature("conservative rasterization", c.conservativeRasterization, "used by voxelize", "missing; triangles are dilated instead");
  printFeature("geometry shader", c.geometryShader, "used by voxelize where conservative rasterization is missing",
               "missing; voxelize runs as compute");
  printFeature("push descriptors", c.pushDescriptor, "used", "missing; descriptors come from pools");
  printFeature("depth clamp", c.depthClamp, "used by shadow_map", "missing; near planes are moved back");
  printFeature("timestamps", c.timestampPeriodNs > 0.f, "used by --stats", "missing; --stats has wall times only");
  printFeature("debug names", c.debugUtils, "used", "missing; objects have no names");
  printFeature("64-bit atomics", c.int64Atomics, "there, not needed (sums are pairs of 32-bit words)", "missing, not needed");
  printFeature("ray query", c.rayQuery, "there, not used yet", "missing, not used yet");
}

void printDevices() {
  std::cout << "devices\n";
  std::unique_ptr<gpu::Device> best;
  try {
    best = gpu::Device::create();
  } catch (const Error& e) {
    std::cout << "  none: " << e.what() << "\n";
    return;
  }
  uint32_t count = 0;
  gpu::check(vkEnumeratePhysicalDevices(best->instance(), &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  gpu::check(vkEnumeratePhysicalDevices(best->instance(), &count, handles.data()), "vkEnumeratePhysicalDevices");
  for (uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(handles[i], &properties);
    std::cout << "  " << i << ": " << properties.deviceName << " (" << printType(properties.deviceType) << ", Vulkan "
              << printVersion(properties.apiVersion) << ")" << (handles[i] == best->physicalDevice() ? ", the default" : "") << "\n";
    const gpu::DeviceRequirements requirements(handles[i]);
    if (!requirements.missing().empty()) {
      std::cout << "    cannot run Radivox; it lacks";
      for (const std::string& name : requirements.missing()) std::cout << " " << name;
      std::cout << "\n";
    } else if (handles[i] == best->physicalDevice()) {
      printCapabilities(best->capabilities());
    } else {
      gpu::DeviceOptions options;
      options.index = static_cast<int>(i);
      printCapabilities(gpu::Device::create(options)->capabilities());
    }
  }
}

void printParams(const params::Table& table) {
  for (const params::Param& param : table.all()) {
    std::cout << "    " << param.name << " = " << param.defaultValue << "  (" << printAllowed(param) << ")  " << param.help << "\n";
  }
}

void printNodes(const Options& options) {
  plugin::Registry registry;
  fillRegistry(options, registry);
  std::cout << "\nnode types\n";
  for (const plugin::NodeType& type : registry.types()) {
    std::cout << "  " << type.name << " (" << type.origin << "): " << type.help << "\n";
    printParams(registry.make(type.name)->params());
  }
  scene::LightOptions defaults;
  std::cout << "  lights (of every graph): how lights cast shadows\n";
  printParams(lightTable(defaults));
}

void printAssets(const char* title, const std::vector<Asset>& assets) {
  std::cout << "\n" << title << "\n";
  for (const Asset& asset : assets) {
    const auto parsed = nlohmann::json::parse(asset.text, nullptr, false);
    std::cout << "  " << asset.name;
    if (parsed.is_object() && parsed.contains("help")) std::cout << ": " << parsed["help"].get<std::string>();
    std::cout << "\n";
  }
}

}  // namespace

int runInfo(const Options& options) {
  std::cout << "radivox " << RADIVOX_VERSION << "\n\n";
  printDevices();
  printNodes(options);
  std::cout << "\nbuilt-in scenes\n";
  for (const scene::BuiltinInfo& builtin : scene::builtinScenes()) {
    std::cout << "  builtin:" << builtin.name;
    for (size_t i = 0; i < builtin.parameters.size(); ++i) std::cout << (i == 0 ? "?" : "&") << builtin.parameters[i];
    std::cout << ": " << builtin.help << "\n";
  }
  printAssets("graphs", graphs());
  printAssets("presets", presets());
  return 0;
}

}  // namespace radivox::cli
