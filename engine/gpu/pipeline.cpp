#include "engine/gpu/pipeline.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <tuple>
#include <utility>

#include "engine/gpu/compile_pool.h"
#include "engine/gpu/shader_reflection.h"

namespace radivox::gpu {

namespace {

/// A shader module for the time of pipeline creation.
class ShaderModule {
 public:
  ShaderModule(Device& device, std::span<const uint32_t> words) : device_(device) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    check(vkCreateShaderModule(device.handle(), &info, nullptr, &module_), "vkCreateShaderModule");
  }
  ~ShaderModule() { vkDestroyShaderModule(device_.handle(), module_, nullptr); }
  ShaderModule(const ShaderModule&) = delete;
  ShaderModule& operator=(const ShaderModule&) = delete;
  VkShaderModule handle() const { return module_; }

 private:
  Device& device_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

/// Values and map entries, kept together while the pipeline is made.
struct Specialization {
  explicit Specialization(const std::vector<SpecializationConstant>& constants) {
    for (const auto& constant : constants) {
      entries.push_back({constant.id, static_cast<uint32_t>(values.size() * sizeof(uint32_t)), sizeof(uint32_t)});
      values.push_back(constant.value);
    }
    info.mapEntryCount = static_cast<uint32_t>(entries.size());
    info.pMapEntries = entries.data();
    info.dataSize = values.size() * sizeof(uint32_t);
    info.pData = values.data();
  }
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<uint32_t> values;
  VkSpecializationInfo info{};
};

/// Every binding is visible to every stage, so a stage's limits hold for all bindings together.
void checkStageLimits(const Device& device, const std::vector<BindingType>& bindings) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device.physicalDevice(), &properties);
  const VkPhysicalDeviceLimits& limits = properties.limits;
  const auto images = static_cast<uint32_t>(std::count(bindings.begin(), bindings.end(), BindingType::SampledImage));
  const std::tuple<BindingType, uint32_t, const char*> kinds[] = {
      {BindingType::StorageBuffer, limits.maxPerStageDescriptorStorageBuffers, "storage buffers"},
      {BindingType::UniformBuffer, limits.maxPerStageDescriptorUniformBuffers, "uniform buffers"},
      {BindingType::StorageImage, limits.maxPerStageDescriptorStorageImages, "storage images"},
      {BindingType::SampledImage, std::min(limits.maxPerStageDescriptorSampledImages, limits.maxPerStageDescriptorSamplers),
       "sampled images"},
      {BindingType::TexelBuffer, limits.maxPerStageDescriptorSampledImages - std::min(limits.maxPerStageDescriptorSampledImages, images),
       "texel buffers beside sampled images"}};
  for (const auto& [type, limit, name] : kinds) {
    const auto count = std::count(bindings.begin(), bindings.end(), type);
    if (count > static_cast<std::ptrdiff_t>(limit)) {
      throw Error(ErrorCode::Unsupported, std::to_string(count) + " " + name + ", but " + device.capabilities().deviceName + " allows " +
                                              std::to_string(limit) + " in a shader");
    }
  }
}

VkDescriptorType descriptorType(BindingType type) {
  switch (type) {
    case BindingType::UniformBuffer:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingType::StorageImage:
      return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case BindingType::SampledImage:
      return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    case BindingType::TexelBuffer:
      return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case BindingType::StorageBuffer:
      break;
  }
  return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

VkPipeline compileCompute(Device& device, VkPipelineLayout layout, std::span<const uint32_t> words,
                          const std::vector<SpecializationConstant>& constants, const std::string& name) {
  const ShaderModule module(device, words);
  const Specialization specialization(constants);
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = module.handle();
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &specialization.info;
  create.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device.handle(), device.pipelineCache(), 1, &create, nullptr, &pipeline), "vkCreateComputePipelines");
  device.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline), name);
  return pipeline;
}

}  // namespace

Pipeline::Pipeline(Device& device, const ComputePipelineInfo& info)
    : device_(&device), bindings_(info.bindings), imageKinds_(info.bindings.size()) {
  try {
    makeCompute(device, info);
  } catch (const Error& error) {
    release();
    throw Error(error.code(), "pipeline " + std::string(info.shader) + ": " + error.what());
  }
}

void Pipeline::makeCompute(Device& device, const ComputePipelineInfo& info) {
  const std::span<const uint32_t> words = info.code.empty() ? findShader(info.shader) : info.code;
  reflect(words);
  makeLayout(device, info.pushConstantBytes, VK_SHADER_STAGE_COMPUTE_BIT);
  // The task outlives `info`; this pipeline's layout outlives the task.
  compiled_ = device.compilePool().run([&device, layout = layout_, words, own = std::vector<uint32_t>(info.code.begin(), info.code.end()),
                                        constants = info.constants, name = std::string(info.shader)] {
    try {
      return compileCompute(device, layout, own.empty() ? words : std::span<const uint32_t>(own), constants, name);
    } catch (const Error& error) {
      throw Error(error.code(), "pipeline " + name + ": " + error.what());
    }
  });
}

VkPipeline Pipeline::handle() const {
  if (compiled_.valid()) pipeline_ = compiled_.get();
  return pipeline_;
}

Pipeline::Pipeline(Device& device, const RasterPipelineInfo& info)
    : device_(&device), bindPoint_(VK_PIPELINE_BIND_POINT_GRAPHICS), bindings_(info.bindings), imageKinds_(info.bindings.size()) {
  try {
    makeRaster(device, info);
  } catch (const Error& error) {
    release();
    throw Error(error.code(), "pipeline " + std::string(info.vertexShader) + ": " + error.what());
  }
  device.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), std::string(info.vertexShader));
}

void Pipeline::makeRaster(Device& device, const RasterPipelineInfo& info) {
  const Capabilities& can = device.capabilities();
  if (!info.geometryShader.empty() && !can.geometryShader) {
    throw Error(ErrorCode::Unsupported, can.deviceName + " has no geometry shaders");
  }
  if (info.conservative && !can.conservativeRasterization) {
    throw Error(ErrorCode::Unsupported, can.deviceName + " has no VK_EXT_conservative_rasterization");
  }
  if (info.depthClamp && !can.depthClamp) throw Error(ErrorCode::Unsupported, can.deviceName + " has no depthClamp");

  const std::pair<std::string_view, VkShaderStageFlagBits> named[] = {{info.vertexShader, VK_SHADER_STAGE_VERTEX_BIT},
                                                                      {info.geometryShader, VK_SHADER_STAGE_GEOMETRY_BIT},
                                                                      {info.fragmentShader, VK_SHADER_STAGE_FRAGMENT_BIT}};
  const Specialization specialization(info.constants);
  std::vector<std::unique_ptr<ShaderModule>> modules;
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  VkShaderStageFlags used = 0;
  for (const auto& [name, stage] : named) {
    if (name.empty()) continue;
    const std::span<const uint32_t> words = findShader(name);
    reflect(words);
    modules.push_back(std::make_unique<ShaderModule>(device, words));
    VkPipelineShaderStageCreateInfo entry{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    entry.stage = stage;
    entry.module = modules.back()->handle();
    entry.pName = "main";
    entry.pSpecializationInfo = &specialization.info;
    stages.push_back(entry);
    used |= static_cast<VkShaderStageFlags>(stage);
  }
  makeLayout(device, info.pushConstantBytes, used);

  const VkPipelineVertexInputStateCreateInfo vertexInput{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationConservativeStateCreateInfoEXT conservative{
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_CONSERVATIVE_STATE_CREATE_INFO_EXT};
  conservative.conservativeRasterizationMode = VK_CONSERVATIVE_RASTERIZATION_MODE_OVERESTIMATE_EXT;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.pNext = info.conservative ? &conservative : nullptr;
  raster.depthClampEnable = info.depthClamp ? VK_TRUE : VK_FALSE;
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = info.cullMode;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1.f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = info.depthFormat != VK_FORMAT_UNDEFINED ? VK_TRUE : VK_FALSE;
  depth.depthWriteEnable = depth.depthTestEnable;
  depth.depthCompareOp = info.depthCompare;
  VkPipelineColorBlendAttachmentState color{};
  color.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  color.blendEnable = info.blend ? VK_TRUE : VK_FALSE;
  color.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  color.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  color.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  color.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  const std::vector<VkPipelineColorBlendAttachmentState> attachments(info.colorFormats.size(), color);
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = static_cast<uint32_t>(attachments.size());
  blend.pAttachments = attachments.data();
  const VkDynamicState dynamicStates[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamicStates;
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = static_cast<uint32_t>(info.colorFormats.size());
  rendering.pColorAttachmentFormats = info.colorFormats.data();
  rendering.depthAttachmentFormat = info.depthFormat;

  VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
  create.stageCount = static_cast<uint32_t>(stages.size());
  create.pStages = stages.data();
  create.pVertexInputState = &vertexInput;
  create.pInputAssemblyState = &assembly;
  create.pViewportState = &viewport;
  create.pRasterizationState = &raster;
  create.pMultisampleState = &samples;
  create.pDepthStencilState = &depth;
  create.pColorBlendState = &blend;
  create.pDynamicState = &dynamic;
  create.layout = layout_;
  check(vkCreateGraphicsPipelines(device.handle(), device.pipelineCache(), 1, &create, nullptr, &pipeline_), "vkCreateGraphicsPipelines");
}

void Pipeline::reflect(std::span<const uint32_t> words) {
  reflectImageKinds(words, imageKinds_);
  for (size_t i = 0; i < bindings_.size(); ++i)
    if (imageKinds_[i].buffer && bindings_[i] == BindingType::StorageBuffer) bindings_[i] = BindingType::TexelBuffer;
}

void Pipeline::makeLayout(Device& device, uint32_t pushBytes, VkShaderStageFlags stages) {
  if (bindings_.size() > kMaxBindings) {
    throw Error(ErrorCode::Unsupported,
                std::to_string(bindings_.size()) + " bindings; at most " + std::to_string(kMaxBindings) + " are allowed");
  }
  if (pushBytes > 128) throw Error(ErrorCode::Unsupported, std::to_string(pushBytes) + " bytes of push constants; at most 128 are allowed");
  checkStageLimits(device, bindings_);
  stages_ = stages;
  pushConstantBytes_ = pushBytes;
  std::vector<VkDescriptorSetLayoutBinding> entries;
  for (size_t i = 0; i < bindings_.size(); ++i) {
    entries.push_back({static_cast<uint32_t>(i), descriptorType(bindings_[i]), 1, stages, nullptr});
  }
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  if (device.capabilities().pushDescriptor) set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = static_cast<uint32_t>(entries.size());
  set.pBindings = entries.data();
  check(vkCreateDescriptorSetLayout(device.handle(), &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{stages, 0, (pushBytes + 3) / 4 * 4};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &setLayout_;
  layout.pushConstantRangeCount = pushBytes > 0 ? 1 : 0;
  layout.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(device.handle(), &layout, nullptr, &layout_), "vkCreatePipelineLayout");
}

Pipeline::Pipeline(Pipeline&& other) noexcept { *this = std::move(other); }

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  compiled_ = std::move(other.compiled_);
  pipeline_ = std::exchange(other.pipeline_, VK_NULL_HANDLE);
  layout_ = std::exchange(other.layout_, VK_NULL_HANDLE);
  setLayout_ = std::exchange(other.setLayout_, VK_NULL_HANDLE);
  bindPoint_ = other.bindPoint_;
  stages_ = other.stages_;
  bindings_ = std::move(other.bindings_);
  imageKinds_ = std::move(other.imageKinds_);
  pushConstantBytes_ = other.pushConstantBytes_;
  return *this;
}

Pipeline::~Pipeline() { release(); }

void Pipeline::release() noexcept {
  if (device_ == nullptr) return;
  try {
    handle();
  } catch (const std::exception&) {  // nothing was made
  }
  vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
  vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_->handle(), setLayout_, nullptr);
  pipeline_ = VK_NULL_HANDLE;
  layout_ = VK_NULL_HANDLE;
  setLayout_ = VK_NULL_HANDLE;
  device_ = nullptr;
}

}  // namespace radivox::gpu
