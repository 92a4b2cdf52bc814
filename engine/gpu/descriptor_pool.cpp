#include "engine/gpu/commands.h"
#include "engine/gpu/staging.h"

namespace radivox::gpu {

namespace {

constexpr uint32_t kSetsPerPool = 1024;

VkFormat formatOf(TexelType type) {
  switch (type) {
    case TexelType::Uint:
      return VK_FORMAT_R32_UINT;
    case TexelType::Int:
      return VK_FORMAT_R32_SINT;
    case TexelType::Float:
      break;
  }
  return VK_FORMAT_R32G32B32A32_SFLOAT;
}

}  // namespace

DescriptorPool::DescriptorPool(Device& device) : device_(device), placeholderBuffer_(device, "placeholder", 256) {
  size_t index = 0;
  for (TexelType type : {TexelType::Float, TexelType::Uint, TexelType::Int}) {
    for (bool array : {false, true}) {
      placeholderImages_[index++] = Image(device, "placeholder", {.format = formatOf(type), .arrayView = array});
    }
  }
  device.submitAndWait([&](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, placeholderBuffer_.handle(), 0, VK_WHOLE_SIZE, 0);
    const VkClearColorValue black{};
    const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    for (Image& image : placeholderImages_) {
      recordTransition(commands, image.handle(), image.aspect(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
      vkCmdClearColorImage(commands, image.handle(), VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
      image.layout = VK_IMAGE_LAYOUT_GENERAL;
    }
    recordFullBarrier(commands);
  });

  VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler.magFilter = VK_FILTER_NEAREST;
  sampler.minFilter = VK_FILTER_NEAREST;
  sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  sampler.addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  sampler.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  check(vkCreateSampler(device.handle(), &sampler, nullptr, &sampler_), "vkCreateSampler");
}

DescriptorPool::~DescriptorPool() {
  for (VkDescriptorPool pool : pools_) vkDestroyDescriptorPool(device_.handle(), pool, nullptr);
  vkDestroySampler(device_.handle(), sampler_, nullptr);
}

const Image& DescriptorPool::placeholder(ImageKind kind) const {
  return placeholderImages_[static_cast<size_t>(kind.texel) * 2 + (kind.array ? 1 : 0)];
}

VkDescriptorSet DescriptorPool::take(const Pipeline& pipeline) {
  const VkDescriptorSetLayout layout = pipeline.setLayout();
  for (;; ++current_) {
    if (current_ == pools_.size()) {
      // On average eight storage buffers a set; a set that no longer fits goes to the next pool.
      const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 8 * kSetsPerPool},
                                            {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, kSetsPerPool},
                                            {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 2 * kSetsPerPool},
                                            {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * kSetsPerPool},
                                            {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kSetsPerPool}};
      VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
      info.maxSets = kSetsPerPool;
      info.poolSizeCount = static_cast<uint32_t>(std::size(sizes));
      info.pPoolSizes = sizes;
      pools_.reserve(pools_.size() + 1);
      VkDescriptorPool pool = VK_NULL_HANDLE;
      check(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &pool), "vkCreateDescriptorPool");
      pools_.push_back(pool);
    }
    VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    info.descriptorPool = pools_[current_];
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    VkDescriptorSet set = VK_NULL_HANDLE;
    const VkResult result = vkAllocateDescriptorSets(device_.handle(), &info, &set);
    if (result == VK_SUCCESS) return set;
    if (result != VK_ERROR_OUT_OF_POOL_MEMORY && result != VK_ERROR_FRAGMENTED_POOL) check(result, "vkAllocateDescriptorSets");
  }
}

void DescriptorPool::reset() {
  for (VkDescriptorPool pool : pools_) check(vkResetDescriptorPool(device_.handle(), pool, 0), "vkResetDescriptorPool");
  current_ = 0;
}

}  // namespace radivox::gpu
