// The embedding printed in README.md, on a device that a host has made, with validation.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "engine/gpu/device.h"
#include "engine/gpu/requirements.h"

using namespace radivox;

/// As extracted from README.md.
void embed(const gpu::AdoptInfo& hostDevice, const std::string& graphJson, VkCommandBuffer (*begin)(),
           void (*submitAndWait)(VkCommandBuffer));

namespace {

std::vector<std::string> messages;
VkQueue queue = VK_NULL_HANDLE;
VkCommandBuffer hostCommands = VK_NULL_HANDLE;
int submitCount = 0;

VKAPI_ATTR VkBool32 VKAPI_CALL note(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* data, void*) {
  messages.push_back(data->pMessage);
  return VK_FALSE;
}

/// What any host has: an instance, a device with what Radivox asks for, a command buffer of its own.
class Host {
 public:
  Host() {
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = VK_API_VERSION_1_3;
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = note;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, &messenger};
    info.pApplicationInfo = &application;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &layer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
    gpu::check(vkCreateInstance(&info, nullptr, &adopt.instance), "vkCreateInstance");
    const auto create =
        reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(adopt.instance, "vkCreateDebugUtilsMessengerEXT"));
    gpu::check(create(adopt.instance, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");

    uint32_t count = 1;
    const VkResult found = vkEnumeratePhysicalDevices(adopt.instance, &count, &adopt.physicalDevice);
    if (found != VK_INCOMPLETE) gpu::check(found, "vkEnumeratePhysicalDevices");
    const gpu::DeviceRequirements requirements(adopt.physicalDevice);
    EXPECT_TRUE(requirements.missing().empty());
    adopt.queueFamily = requirements.queueFamily();
    adopt.deviceExtensions = {requirements.extensions().begin(), requirements.extensions().end()};
    const float priority = 1.f;
    VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queueInfo.queueFamilyIndex = adopt.queueFamily;
    queueInfo.queueCount = 1;
    queueInfo.pQueuePriorities = &priority;
    VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, requirements.chain()};
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queueInfo;
    device.enabledExtensionCount = static_cast<uint32_t>(requirements.extensions().size());
    device.ppEnabledExtensionNames = requirements.extensions().data();
    gpu::check(vkCreateDevice(adopt.physicalDevice, &device, nullptr, &adopt.device), "vkCreateDevice");
    vkGetDeviceQueue(adopt.device, adopt.queueFamily, 0, &adopt.queue);
    queue = adopt.queue;

    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = adopt.queueFamily;
    gpu::check(vkCreateCommandPool(adopt.device, &pool, nullptr, &pool_), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.commandBufferCount = 1;
    gpu::check(vkAllocateCommandBuffers(adopt.device, &allocate, &hostCommands), "vkAllocateCommandBuffers");
  }
  ~Host() {
    vkDestroyCommandPool(adopt.device, pool_, nullptr);
    vkDestroyDevice(adopt.device, nullptr);
    const auto destroy =
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(adopt.instance, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(adopt.instance, messenger_, nullptr);
    vkDestroyInstance(adopt.instance, nullptr);
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  gpu::AdoptInfo adopt;

 private:
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
};

VkCommandBuffer begin() {
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  gpu::check(vkBeginCommandBuffer(hostCommands, &info), "vkBeginCommandBuffer");
  return hostCommands;
}

void submitAndWait(VkCommandBuffer commands) {
  ++submitCount;
  gpu::check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  gpu::check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  gpu::check(vkQueueWaitIdle(queue), "vkQueueWaitIdle");
}

TEST(Embedding, SlowWorksAsPrintedInTheReadme) {
  std::ifstream file(RADIVOX_SOURCE_DIR "/samples/graphs/clustered_voxel.json");
  const std::string graph((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  messages.clear();
  submitCount = 0;
  {
    Host host;
    ASSERT_NO_THROW(embed(host.adopt, graph, begin, submitAndWait));
  }  // destroying the device tells of every handle that was left
  EXPECT_GE(submitCount, 2) << "frames were recorded into the host's command buffer";
  EXPECT_EQ(messages, std::vector<std::string>());
}

}  // namespace
