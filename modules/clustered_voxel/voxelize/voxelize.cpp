#include "modules/clustered_voxel/voxelize/voxelize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Shape;

Voxelize::Voxelize()
    : table_({params::swept(params::number("resolution", &resolution_, {8, 1024}, "voxels along the longest side of the bounds",
                                           params::Invalidates::Plan),
                            {"32", "64", "128", "256"}, "256"),
              params::choice("sides", &sides_, {"both", "gltf"},
                             "both: every surface reflects on both sides; gltf: single-sided materials on the front only",
                             params::Invalidates::Plan),
              params::choice(
                  "faces", &faces_, {"projected", "dominant"},
                  "projected: surface belongs to all faces that it looks along, by its projected area (paper); dominant: to the one that "
                  "it looks along the most, which is six tenths of the faces",
                  params::Invalidates::Plan),
              TrianglePass::methodParam(&method_)}) {}

/// Where even the shortest edge is many voxels long, more of them add detail to the light, but none to the shape.
std::string Voxelize::adviseResolution(const scene::Traits& traits) const {
  constexpr double kVoxelsAnEdge = 4;
  if (!(traits.shortestEdge > 0)) return "";
  const glm::dvec3 extent = glm::dvec3(traits.boundsMax) - glm::dvec3(traits.boundsMin);
  const double enough = kVoxelsAnEdge * std::max({extent.x, extent.y, extent.z}) / traits.shortestEdge + 1;
  if (2 * enough > resolution_) return "";  // half would not do
  const auto fewer = std::max(8u, static_cast<uint32_t>(std::ceil(enough)));
  const uint64_t now = grid_.brickCount, then = makeGrid(traits, fewer).brickCount;
  return "resolution=" + std::to_string(resolution_) + " is more than the shapes need: at " + std::to_string(fewer) +
         " every edge is four voxels long or more, with " + std::to_string(then) + " bricks instead of " + std::to_string(now) +
         "; light and shadow would lose detail, so it is not done";
}

void Voxelize::declare(graph::Declaration& d) {
  grid_ = makeGridWithin(d.traits, resolution_, d.capabilities.maxStorageBufferRange, "voxelize.resolution");
  grid_.singleSided = sides_ == Sides::Gltf ? 1 : 0;
  grid_.dominant = faces_ == Faces::Dominant ? 1 : 0;
  d.advise(adviseResolution(d.traits));
  TrianglePass::declare(d, method_);
  const uint32_t use = TrianglePass::useOf(method_) | graph::UseTransfer;
  d.write("grid", Shape::buffer(sizeof(shared::Grid), 1), "Grid: origin, voxel edge and size", use);
  d.write("occupancy", Shape::buffer(8, grid_.brickCount), "a bit a voxel, two words a brick of 4³; 0: free", use);
  d.write("count", Shape::buffer(4, 4), "occupied voxels, 0, 0, 0");
  d.publishCount("voxels", "count", 0);
  d.publishCount("bricks", "grid", offsetof(shared::Grid, brickCount));
}

void Voxelize::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  pass_.prepare(device, method_, kType, "voxelize", 5, {});
  countVoxels_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/count_voxels.comp",
                                                                .bindings = {BindingType::StorageBuffer, BindingType::StorageBuffer},
                                                                .pushConstantBytes = 4});
}

void Voxelize::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& grid = context.buffer("grid");
  const gpu::Buffer& occupancy = context.buffer("occupancy");
  const gpu::Buffer& count = context.buffer("count");
  commands.update(grid, &grid_, sizeof(grid_));
  commands.fill(occupancy, 0);
  commands.fill(count, 0);
  commands.barrier();
  const std::array<gpu::BoundResource, 1> rest = {occupancy};
  pass_.record(context, grid, rest);
  commands.barrier();
  commands.bind(countVoxels_, {occupancy, count});
  commands.push(grid_.brickCount);
  commands.dispatchItems(grid_.brickCount, 256);
}

}  // namespace radivox::clustered_voxel
