#include "modules/clustered_voxel/structure.h"

#include <array>
#include <cassert>

namespace radivox::clustered_voxel {

void declareStructure(graph::Declaration& d, bool mask) {
  d.read("grid", "Grid");
  d.read("occupancy", "two words a brick");
  d.read("rank", "occupied voxels before the brick");
  if (mask) d.read("mask", "faces of each voxel");
  d.read("first", "first face of each voxel");
  d.read("faces", "Face");
  d.read("voxels", "packed coordinate of each voxel");
}

void readEmission(graph::Declaration& d, const char* name, const char* meaning) {
  d.readIf(d.traits.hasEmissionByRays(), name, meaning,
           d.traits.emissiveTriangleCount == 0 ? "nothing emits" : "emitters have samples with shadow maps");
}

void bindStructure(graph::RecordContext& context, const gpu::Pipeline& pipeline, std::initializer_list<gpu::BoundResource> rest,
                   const char* mask) {
  constexpr size_t kMost = 32;
  assert(6 + rest.size() <= kMost);
  const gpu::Buffer& grid = context.buffer("grid");
  // A fixed array: recording allocates nothing.
  std::array<gpu::BoundResource, kMost> all = {grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid,
                                               grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid,
                                               grid, grid, grid, grid, grid, grid, grid, grid, grid, grid};
  size_t i = 0;
  for (const char* name : {"grid", "occupancy", "rank", mask, "first", "faces"}) all[i++] = context.buffer(name);
  for (const gpu::BoundResource& resource : rest) all[i++] = resource;
  context.commands().bind(pipeline, std::span<const gpu::BoundResource>(all.data(), i));
}

}  // namespace radivox::clustered_voxel
