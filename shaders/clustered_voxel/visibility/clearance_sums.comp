#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Clearance, passes 1 to 3: how many voxels up to this one, along axis 0, then 1, then 2, a ray may not pass: those with faces, and the rim. A lane
// sweeps a line of the grid with its rim, here a word a voxel.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kAxis = 0;
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_FACE_MASK 3
layout(set = 0, binding = 4, scalar) buffer Sums { uint sums[]; };
#include "shared/clearance.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

uint blocks(ivec3 coordinate) {
  uint voxel = voxelIndex(coordinate);
  return !isInside(coordinate) || (voxel != kNone && faceMask(voxel) != 0u) ? 1u : 0u;
}

void main() {
  uvec3 size = grid.size + 2u;
  const uint u = kAxis == 0u ? 1u : 0u, v = kAxis == 2u ? 1u : 2u;  // the other axes
  uint line = radivoxItemIndex();
  if (line >= size[u] * size[v]) return;
  uvec3 at = uvec3(0u);
  at[u] = line % size[u];
  at[v] = line / size[u];
  uvec3 strides = uvec3(1u, size.x, size.x * size.y);
  uint index = clearanceSumIndex(at, grid.size);
  uint sum = 0u;
  for (uint i = 0u; i < size[kAxis]; ++i, index += strides[kAxis]) {
    at[kAxis] = i;
    sum += kAxis == 0u ? blocks(ivec3(at) - 1) : sums[index];
    sums[index] = sum;
  }
}
