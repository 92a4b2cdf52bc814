#include "modules/clustered_voxel/voxelize/faces.h"

#include <array>

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

std::vector<gpu::SpecializationConstant> materialConstants(const scene::Traits& traits) {
  return {{0, traits.hasTextures() ? 1u : 0u}, {1, traits.hasAlphaMasks() ? 1u : 0u}, {2, traits.hasEmitters() ? 1u : 0u}};
}

Faces::Faces() : table_({TrianglePass::methodParam(&method_)}) {}

void Faces::declare(graph::Declaration& d) {
  const uint32_t use = TrianglePass::useOf(method_);
  TrianglePass::declare(d, method_);
  d.read("scene.triangle_materials", "one a triangle", use);
  d.read("scene.materials", "Material", use);
  d.read("scene.textures", "Texture", use);
  d.read("grid", "Grid", use);
  d.read("occupancy", "two words a brick", use);
  d.read("rank", "occupied voxels before the brick", use);
  const Extent voxels = Extent::of("voxels");
  d.write("mask", Shape::buffer(4, voxels), "bit f of each voxel: face f carries surface", use | graph::UseTransfer);
  d.write("first", Shape::buffer(4, voxels + 1), "faces before each voxel, then their number");
  d.write("count", Shape::buffer(4, 1), "voxel faces");
  d.scratch("scan", Shape::buffer(4, voxels / 256 + 4096), "scan of the faces");
  d.publishCount("faces", "count", 0);
}

void Faces::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  pass_.prepare(device, method_, kType, "faces", 10, materialConstants(context.traits()));
  numberFaces_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/number_faces.comp",
                                                                .bindings = {BindingType::StorageBuffer, BindingType::StorageBuffer},
                                                                .pushConstantBytes = 4});
  scan_ = std::make_unique<gpu::Scan>(device);
}

void Faces::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& mask = context.buffer("mask");
  const gpu::Buffer& first = context.buffer("first");
  const gpu::Buffer& grid = context.buffer("grid");
  const auto voxelCount = static_cast<uint32_t>(context.count("voxels"));
  commands.fill(mask, 0);
  commands.barrier();
  const std::array<gpu::BoundResource, 6> rest = {context.buffer("scene.triangle_materials"),
                                                  context.buffer("scene.materials"),
                                                  context.buffer("scene.textures"),
                                                  context.buffer("occupancy"),
                                                  context.buffer("rank"),
                                                  mask};
  pass_.record(context, grid, rest);
  commands.barrier();
  commands.bind(numberFaces_, {mask, first});
  commands.push(voxelCount);
  commands.dispatchItems(uint64_t{voxelCount} + 1, 64);
  scan_->scan(commands, first, first, uint64_t{voxelCount} + 1, context.buffer("scan"));
  commands.copy(first, context.buffer("count"), 4, 4 * uint64_t{voxelCount});
}

}  // namespace radivox::clustered_voxel
