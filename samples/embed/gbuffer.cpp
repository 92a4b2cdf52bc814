#include "gbuffer.h"

#include <cstring>
#include <span>

#include "gbuffer.frag.h"
#include "gbuffer.vert.h"

namespace {

constexpr VkFormat kFormats[HostGBuffer::Count] = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                                   VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_UINT};

VkShaderModule makeShader(VkDevice device, std::span<const uint32_t> words) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = words.size_bytes();
  info.pCode = words.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device, &info, nullptr, &shader), "vkCreateShaderModule");
  return shader;
}

}  // namespace

HostGBuffer::HostGBuffer(Host& host, const std::vector<HostVertex>& vertices)
    : host_(host),
      depth_(host.makeImage(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT)),
      vertices_(host.makeBuffer(vertices.size() * sizeof(HostVertex), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)),
      view_(host.makeBuffer(sizeof(HostView), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)),
      vertexCount_(static_cast<uint32_t>(vertices.size())) {
  for (int i = 0; i < Count; ++i) {
    images[i] = host.makeImage(kFormats[i], VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_STORAGE_BIT);
  }
  std::memcpy(vertices_.mapped, vertices.data(), vertices.size() * sizeof(HostVertex));

  const VkPushConstantRange push{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, 2 * sizeof(VkDeviceAddress)};
  VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layoutInfo.pushConstantRangeCount = 1;
  layoutInfo.pPushConstantRanges = &push;
  check(vkCreatePipelineLayout(host.device, &layoutInfo, nullptr, &layout_), "vkCreatePipelineLayout");

  VkPipelineShaderStageCreateInfo stages[2] = {{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO},
                                               {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO}};
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = makeShader(host.device, gbuffer_vert);
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = makeShader(host.device, gbuffer_frag);
  stages[0].pName = stages[1].pName = "main";
  // No vertex input: the shaders read the vertices by their address.
  const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const VkViewport viewport{0, 0, static_cast<float>(host.width), static_cast<float>(host.height), 0, 1};
  const VkRect2D scissor{{0, 0}, {host.width, host.height}};
  VkPipelineViewportStateCreateInfo viewports{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewports.viewportCount = viewports.scissorCount = 1;
  viewports.pViewports = &viewport;
  viewports.pScissors = &scissor;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1.f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;
  VkPipelineColorBlendAttachmentState blend[Count] = {};
  for (auto& attachment : blend) attachment.colorWriteMask = 15;
  VkPipelineColorBlendStateCreateInfo blending{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blending.attachmentCount = Count;
  blending.pAttachments = blend;
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = Count;
  rendering.pColorAttachmentFormats = kFormats;
  rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewports;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blending;
  info.layout = layout_;
  check(vkCreateGraphicsPipelines(host.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_), "vkCreateGraphicsPipelines");
  for (const auto& stage : stages) vkDestroyShaderModule(host.device, stage.module, nullptr);
}

HostGBuffer::~HostGBuffer() {
  vkDestroyPipeline(host_.device, pipeline_, nullptr);
  vkDestroyPipelineLayout(host_.device, layout_, nullptr);
}

void HostGBuffer::draw(VkCommandBuffer commands, const HostView& view) const {
  // Old contents go; whoever read them last (Radivox, in an earlier frame) is waited for.
  VkImageMemoryBarrier2 barriers[Count + 1] = {};
  for (int i = 0; i <= Count; ++i) {
    const bool isDepth = i == Count;
    barriers[i].sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barriers[i].srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barriers[i].dstStageMask = isDepth ? VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT : VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
    barriers[i].dstAccessMask = isDepth ? VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT
                                        : VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
    barriers[i].newLayout = isDepth ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    barriers[i].image = isDepth ? depth_.image : images[i].image;
    barriers[i].subresourceRange = {isDepth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0u, 1, 0, 1};
  }
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = Count + 1;
  dependency.pImageMemoryBarriers = barriers;
  vkCmdPipelineBarrier2(commands, &dependency);

  VkRenderingAttachmentInfo attachments[Count + 1] = {};
  for (int i = 0; i <= Count; ++i) {
    attachments[i].sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    attachments[i].imageView = i == Count ? depth_.view : images[i].view;
    attachments[i].imageLayout = barriers[i].newLayout;
    attachments[i].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    attachments[i].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  }
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea = {{0, 0}, {host_.width, host_.height}};
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = Count;
  rendering.pColorAttachments = attachments;
  rendering.pDepthAttachment = &attachments[Count];
  vkCmdBeginRendering(commands, &rendering);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  std::memcpy(view_.mapped, &view, sizeof view);
  const VkDeviceAddress push[2] = {vertices_.address, view_.address};
  vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof push, push);
  vkCmdDraw(commands, vertexCount_, 1, 0, 0);
  vkCmdEndRendering(commands);
}
