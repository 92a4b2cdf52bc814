#include "modules/clustered_voxel/index/index.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kGroup = 64;
}

void Index::declare(graph::Declaration& d) {
  const Extent bricks = Extent::of("bricks");
  d.read("grid", "Grid");
  d.read("occupancy", "two words a brick");
  d.write("rank", Shape::buffer(4, bricks), "occupied voxels in the bricks before");
  d.write("voxels", Shape::buffer(4, Extent::of("voxels")), "packed coordinate of each voxel");
  d.write("distance", Shape::buffer(4, bricks / 4), "bricks to the nearest occupied one, four a word; 0: occupied, at most 255");
  d.scratch("distance_xy", Shape::buffer(4, bricks / 4), "distance along x and y");
  d.scratch("scan", Shape::buffer(4, bricks / 256 + 4096), "scan of the ranks");
}

void Index::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = BindingType::StorageBuffer;
  brickCounts_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/index/brick_counts.comp", .bindings = {kB, kB}, .pushConstantBytes = 4});
  listVoxels_ =
      gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/index/list_voxels.comp", .bindings = {kB, kB, kB, kB}});
  distance_ = gpu::Pipeline(
      device,
      gpu::ComputePipelineInfo{.shader = "clustered_voxel/index/distance.comp", .bindings = {kB, kB, kB, kB}, .pushConstantBytes = 4});
  scan_ = std::make_unique<gpu::Scan>(device);
}

void Index::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& grid = context.buffer("grid");
  const gpu::Buffer& occupancy = context.buffer("occupancy");
  const gpu::Buffer& rank = context.buffer("rank");
  const gpu::Buffer& distance = context.buffer("distance");
  const gpu::Buffer& partial = context.buffer("distance_xy");
  const auto brickCount = static_cast<uint32_t>(context.count("bricks"));
  commands.bind(brickCounts_, {occupancy, rank});
  commands.push(brickCount);
  commands.dispatchItems(brickCount, kGroup);
  scan_->scan(commands, rank, rank, brickCount, context.buffer("scan"));
  commands.bind(listVoxels_, {grid, occupancy, rank, context.buffer("voxels")});
  commands.dispatchItems(brickCount, kGroup);
  // x into distance, y from there into the scratch, z back into distance.
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const gpu::Buffer& from = axis == 1 ? distance : partial;
    const gpu::Buffer& to = axis == 1 ? partial : distance;
    commands.bind(distance_, {grid, occupancy, from, to});
    commands.push(axis);
    commands.dispatchItems((uint64_t{brickCount} + 3) / 4, kGroup);
    commands.barrier();
  }
}

}  // namespace radivox::clustered_voxel
