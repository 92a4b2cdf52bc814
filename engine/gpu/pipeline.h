// Pipelines made from SPIR-V that the build embedded (see cmake/RadivoxShaders.cmake and shaders/README.md).
// Convention: one descriptor set (set 0); binding i is the i-th entry of `bindings`; push constants at offset 0, at most 128 bytes.
#pragma once

#include <cstdint>
#include <future>
#include <span>
#include <string_view>
#include <vector>

#include "engine/gpu/resources.h"

namespace radivox::gpu {

enum class BindingType : uint8_t {
  StorageBuffer,  ///< TexelBuffer where the shader declares a `samplerBuffer`, a `usamplerBuffer` or an `isamplerBuffer`
  UniformBuffer,
  StorageImage,  ///< layout GENERAL
  SampledImage,  ///< combined image sampler, nearest, clamp to edge; layout GENERAL (colour) or DEPTH_READ_ONLY_OPTIMAL
  TexelBuffer,  ///< a buffer as texels (Buffer::texels): what lanes load from scattered places, which CPU devices do lane by lane otherwise
};

constexpr uint32_t kMaxBindings = 32;  ///< what every device with push descriptors allows

/// What a shader takes an image or a texel buffer for, read from its SPIR-V: bind() finds the placeholder of a null image by it.
struct ImageKind {
  TexelType texel = TexelType::Float;
  bool array = false;
  bool buffer = false;  ///< a texel buffer
};

/// SPIR-V of "clustered_voxel/visibility/trace.comp" (path under shaders/). Throws BadInput for an unknown name.
/// RADIVOX_SHADER_DIR in the environment, if set, is searched for NAME.spv first (development).
std::span<const uint32_t> findShader(std::string_view name);

/// value of `layout(constant_id = id)`; bool and float go through their 32-bit patterns.
struct SpecializationConstant {
  uint32_t id;
  uint32_t value;
};

struct ComputePipelineInfo {
  std::string_view shader;
  std::span<const uint32_t> code;  ///< SPIR-V to use instead of findShader(shader): nodes built outside this tree
  std::vector<BindingType> bindings;
  uint32_t pushConstantBytes = 0;
  std::vector<SpecializationConstant> constants;
};  // use designated initializers: {.shader = "…", .bindings = {…}, .pushConstantBytes = sizeof(Push)}

struct RasterPipelineInfo {
  std::string_view vertexShader;
  std::string_view geometryShader;    ///< empty: none
  std::string_view fragmentShader;    ///< empty: none (depth only)
  std::vector<BindingType> bindings;  ///< visible to all stages
  uint32_t pushConstantBytes = 0;
  std::vector<SpecializationConstant> constants;  ///< the same for all stages
  std::vector<VkFormat> colorFormats;             ///< may be empty (voxelization renders to nothing)
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;
  VkCompareOp depthCompare = VK_COMPARE_OP_GREATER_OR_EQUAL;  ///< reversed z: 1 near, 0 far
  VkCullModeFlags cullMode = VK_CULL_MODE_NONE;
  bool depthClamp = false;
  bool conservative = false;  ///< overestimate; needs Capabilities::conservativeRasterization
  bool blend = false;         ///< colour over what is there by its alpha; alpha stays 1 over 1
};
// Raster pipelines have no vertex input (vertex pulling from storage buffers), triangle lists, front face counter-clockwise,
// dynamic viewport and scissor.

class Pipeline {
 public:
  Pipeline() = default;
  Pipeline(Device& device, const ComputePipelineInfo& info);
  Pipeline(Device& device, const RasterPipelineInfo& info);
  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&& other) noexcept;
  ~Pipeline();

  /// Compute pipelines are compiled by other threads: waits for it, and throws what went wrong.
  VkPipeline handle() const;
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout setLayout() const { return setLayout_; }
  VkPipelineBindPoint bindPoint() const { return bindPoint_; }
  const std::vector<BindingType>& bindings() const { return bindings_; }    ///< as the shader has them
  const std::vector<ImageKind>& imageKinds() const { return imageKinds_; }  ///< one per binding; other buffers have the default
  uint32_t pushConstantBytes() const { return pushConstantBytes_; }
  VkShaderStageFlags stages() const { return stages_; }
  explicit operator bool() const { return pipeline_ != VK_NULL_HANDLE || compiled_.valid(); }

 private:
  void makeCompute(Device& device, const ComputePipelineInfo& info);
  void makeRaster(Device& device, const RasterPipelineInfo& info);
  /// What bind() must know of a stage: kinds of images, and which buffers are texels.
  void reflect(std::span<const uint32_t> words);
  void makeLayout(Device& device, uint32_t pushBytes, VkShaderStageFlags stages);
  void release() noexcept;
  Device* device_ = nullptr;
  mutable std::future<VkPipeline> compiled_;  ///< until it is asked for
  mutable VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineBindPoint bindPoint_ = VK_PIPELINE_BIND_POINT_COMPUTE;
  VkShaderStageFlags stages_ = 0;
  std::vector<BindingType> bindings_;
  std::vector<ImageKind> imageKinds_;
  uint32_t pushConstantBytes_ = 0;
};

}  // namespace radivox::gpu
