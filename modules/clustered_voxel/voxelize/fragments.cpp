#include "modules/clustered_voxel/voxelize/fragments.h"

#include <array>

#include "modules/clustered_voxel/voxelize/faces.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Fragments::Fragments() : table_({TrianglePass::methodParam(&method_)}) {}

void Fragments::declare(graph::Declaration& d) {
  const uint32_t use = TrianglePass::useOf(method_);
  TrianglePass::declare(d, method_);
  d.read("scene.triangle_materials", "one a triangle", use);
  d.read("scene.materials", "Material", use);
  d.read("scene.textures", "Texture", use);
  d.read("grid", "Grid", use);
  d.read("occupancy", "two words a brick", use);
  d.read("rank", "occupied voxels before the brick", use);
  const Extent voxels = Extent::of("voxels");
  const uint32_t sums = use | graph::UseTransfer;
  d.write("count", Shape::buffer(4, voxels), "triangles that overlap the voxel", sums);
  d.write("normal", Shape::buffer(12, voxels), "unit mean normal; 0: no area, or the normals cancel").optional = true;
  d.scratch("area_sums", Shape::buffer(8, voxels), "Σ area, h²", sums);
  d.scratch("normal_sums", Shape::buffer(24, voxels), "Σ area (n + 1)", sums);
}

void Fragments::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  wantsNormals_ = context.has("normal");
  std::vector<gpu::SpecializationConstant> constants = materialConstants(context.traits());
  constants.push_back({3, wantsNormals_ ? 1u : 0u});
  pass_.prepare(device, method_, kType, "fragments", 12, constants);
  constexpr auto kB = BindingType::StorageBuffer;
  if (wantsNormals_)
    resolve_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .shader = "clustered_voxel/voxelize/fragments_resolve.comp", .bindings = {kB, kB, kB}, .pushConstantBytes = 4});
}

void Fragments::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& count = context.buffer("count");
  const gpu::Buffer& areaSums = context.buffer("area_sums");
  const gpu::Buffer& normalSums = context.buffer("normal_sums");
  commands.fill(count, 0);
  if (wantsNormals_) {
    commands.fill(areaSums, 0);
    commands.fill(normalSums, 0);
  }
  commands.barrier();
  const std::array<gpu::BoundResource, 8> rest = {context.buffer("scene.triangle_materials"),
                                                  context.buffer("scene.materials"),
                                                  context.buffer("scene.textures"),
                                                  context.buffer("occupancy"),
                                                  context.buffer("rank"),
                                                  count,
                                                  areaSums,
                                                  normalSums};
  pass_.record(context, context.buffer("grid"), rest);
  if (!wantsNormals_) return;
  commands.barrier();
  const auto voxelCount = static_cast<uint32_t>(context.count("voxels"));
  commands.bind(resolve_, {areaSums, normalSums, context.buffer("normal")});
  commands.push(voxelCount);
  commands.dispatchItems(voxelCount, 64);
}

}  // namespace radivox::clustered_voxel
