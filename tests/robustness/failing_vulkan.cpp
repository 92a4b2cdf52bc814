#include "tests/robustness/failing_vulkan.h"

#include <dlfcn.h>
#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdlib>
#include <mutex>

namespace radivox::tests {
namespace {

std::atomic<uint64_t> calls{0}, turn{0};
std::atomic<int64_t> live{0};
std::atomic<const char*> failed{nullptr};

/// The loader's own function of that name.
template <class F>
F next(const char* name) {
  auto* found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) std::abort();
  return reinterpret_cast<F>(found);
}

bool isItsTurn(const char* name) {
  if (++calls != turn) return false;
  failed = name;
  return true;
}

}  // namespace

void failCall(uint64_t n) {
  calls = 0;
  turn = n;
  failed = nullptr;
}
uint64_t callCount() { return calls; }
std::string failedCall() {
  const char* name = failed;
  return name == nullptr ? "" : name;
}
int64_t liveObjectCount() { return live; }

}  // namespace radivox::tests

using radivox::tests::failed;
using radivox::tests::isItsTurn;
using radivox::tests::live;
using radivox::tests::next;

// NAME(parameters) calls the next one with (arguments), unless it is its turn to fail with `error`; `made` objects are there afterwards.
#define RADIVOX_FAILING(NAME, parameters, arguments, error, made) \
  extern "C" VKAPI_ATTR VkResult VKAPI_CALL NAME parameters {     \
    static const auto real = next<PFN_##NAME>(#NAME);             \
    if (isItsTurn(#NAME)) return error;                           \
    const VkResult result = real arguments;                       \
    if (result == VK_SUCCESS) live += static_cast<int64_t>(made); \
    return result;                                                \
  }
#define RADIVOX_CREATE(NAME, Info, Handle)                                                                         \
  RADIVOX_FAILING(NAME, (VkDevice device, const Info* info, const VkAllocationCallbacks* allocator, Handle* made), \
                  (device, info, allocator, made), VK_ERROR_OUT_OF_HOST_MEMORY, 1)
#define RADIVOX_DESTROY(NAME, Handle)                                                                          \
  extern "C" VKAPI_ATTR void VKAPI_CALL NAME(VkDevice device, Handle object, const VkAllocationCallbacks* a) { \
    static const auto real = next<PFN_##NAME>(#NAME);                                                          \
    if (object != VK_NULL_HANDLE) --live;                                                                      \
    real(device, object, a);                                                                                   \
  }

RADIVOX_FAILING(vkAllocateMemory, (VkDevice d, const VkMemoryAllocateInfo* i, const VkAllocationCallbacks* a, VkDeviceMemory* m),
                (d, i, a, m), VK_ERROR_OUT_OF_DEVICE_MEMORY, 1)
RADIVOX_DESTROY(vkFreeMemory, VkDeviceMemory)
RADIVOX_CREATE(vkCreateBuffer, VkBufferCreateInfo, VkBuffer)
RADIVOX_DESTROY(vkDestroyBuffer, VkBuffer)
RADIVOX_CREATE(vkCreateBufferView, VkBufferViewCreateInfo, VkBufferView)
RADIVOX_DESTROY(vkDestroyBufferView, VkBufferView)
RADIVOX_CREATE(vkCreateImage, VkImageCreateInfo, VkImage)
RADIVOX_DESTROY(vkDestroyImage, VkImage)
RADIVOX_CREATE(vkCreateImageView, VkImageViewCreateInfo, VkImageView)
RADIVOX_DESTROY(vkDestroyImageView, VkImageView)
RADIVOX_CREATE(vkCreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)
RADIVOX_DESTROY(vkDestroyShaderModule, VkShaderModule)
RADIVOX_CREATE(vkCreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
RADIVOX_DESTROY(vkDestroyPipelineLayout, VkPipelineLayout)
RADIVOX_CREATE(vkCreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
RADIVOX_DESTROY(vkDestroyDescriptorSetLayout, VkDescriptorSetLayout)
RADIVOX_CREATE(vkCreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
RADIVOX_DESTROY(vkDestroyDescriptorPool, VkDescriptorPool)
RADIVOX_CREATE(vkCreateSampler, VkSamplerCreateInfo, VkSampler)
RADIVOX_DESTROY(vkDestroySampler, VkSampler)
RADIVOX_CREATE(vkCreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
RADIVOX_DESTROY(vkDestroyCommandPool, VkCommandPool)
RADIVOX_CREATE(vkCreateQueryPool, VkQueryPoolCreateInfo, VkQueryPool)
RADIVOX_DESTROY(vkDestroyQueryPool, VkQueryPool)
RADIVOX_CREATE(vkCreateFence, VkFenceCreateInfo, VkFence)
RADIVOX_DESTROY(vkDestroyFence, VkFence)
RADIVOX_CREATE(vkCreatePipelineCache, VkPipelineCacheCreateInfo, VkPipelineCache)
RADIVOX_DESTROY(vkDestroyPipelineCache, VkPipelineCache)
RADIVOX_FAILING(vkCreateComputePipelines,
                (VkDevice d, VkPipelineCache c, uint32_t n, const VkComputePipelineCreateInfo* i, const VkAllocationCallbacks* a,
                 VkPipeline* p),
                (d, c, n, i, a, p), VK_ERROR_OUT_OF_DEVICE_MEMORY, n)
RADIVOX_FAILING(vkCreateGraphicsPipelines,
                (VkDevice d, VkPipelineCache c, uint32_t n, const VkGraphicsPipelineCreateInfo* i, const VkAllocationCallbacks* a,
                 VkPipeline* p),
                (d, c, n, i, a, p), VK_ERROR_OUT_OF_DEVICE_MEMORY, n)
RADIVOX_DESTROY(vkDestroyPipeline, VkPipeline)
RADIVOX_FAILING(vkBindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize o), (d, b, m, o), VK_ERROR_OUT_OF_HOST_MEMORY,
                0)
RADIVOX_FAILING(vkBindImageMemory, (VkDevice d, VkImage b, VkDeviceMemory m, VkDeviceSize o), (d, b, m, o), VK_ERROR_OUT_OF_HOST_MEMORY, 0)
RADIVOX_FAILING(vkMapMemory, (VkDevice d, VkDeviceMemory m, VkDeviceSize o, VkDeviceSize n, VkMemoryMapFlags f, void** p),
                (d, m, o, n, f, p), VK_ERROR_MEMORY_MAP_FAILED, 0)
RADIVOX_FAILING(vkAllocateDescriptorSets, (VkDevice d, const VkDescriptorSetAllocateInfo* i, VkDescriptorSet* s), (d, i, s),
                VK_ERROR_OUT_OF_DEVICE_MEMORY, 0)
RADIVOX_FAILING(vkAllocateCommandBuffers, (VkDevice d, const VkCommandBufferAllocateInfo* i, VkCommandBuffer* c), (d, i, c),
                VK_ERROR_OUT_OF_HOST_MEMORY, 0)
RADIVOX_FAILING(vkBeginCommandBuffer, (VkCommandBuffer c, const VkCommandBufferBeginInfo* i), (c, i), VK_ERROR_OUT_OF_HOST_MEMORY, 0)
RADIVOX_FAILING(vkEndCommandBuffer, (VkCommandBuffer c), (c), VK_ERROR_OUT_OF_DEVICE_MEMORY, 0)
RADIVOX_FAILING(vkQueueSubmit2, (VkQueue q, uint32_t n, const VkSubmitInfo2* i, VkFence f), (q, n, i, f), VK_ERROR_DEVICE_LOST, 0)
RADIVOX_FAILING(vkGetQueryPoolResults,
                (VkDevice d, VkQueryPool p, uint32_t first, uint32_t n, size_t bytes, void* data, VkDeviceSize stride,
                 VkQueryResultFlags f),
                (d, p, first, n, bytes, data, stride, f), VK_ERROR_DEVICE_LOST, 0)

// The work is done all the same: a driver that says otherwise must not be left with the work's memory freed under it.
extern "C" VKAPI_ATTR VkResult VKAPI_CALL vkWaitForFences(VkDevice d, uint32_t n, const VkFence* f, VkBool32 all, uint64_t timeout) {
  static const auto real = next<PFN_vkWaitForFences>("vkWaitForFences");
  const bool fails = isItsTurn("vkWaitForFences");
  const VkResult result = real(d, n, f, all, timeout);
  return fails ? VK_ERROR_DEVICE_LOST : result;
}
