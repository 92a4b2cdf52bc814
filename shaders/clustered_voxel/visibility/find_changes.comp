#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// A lane an old voxel: is it as it was? `changed` begins as the bits of all voxels there are now; those of voxels that are as they were go, and those
// of voxels that are no more are set.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/kept_hits.glsl"
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
layout(set = 0, binding = 3, scalar) buffer Changed { uint changed[]; };  // two words a brick
layout(push_constant, scalar) uniform Push {
  KeptHits old;
  KeptHits now;
};
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= old.voxelCount) return;
  uvec3 coordinate = unpackVoxel(keptWord(old, voxel));
  uint bit = bitOf(coordinate);
  uint word = 2u * brickOf(coordinate, grid.bricks) + (bit >> 5);
  uint here = voxelIndex(ivec3(coordinate));
  bool same = here != kNone;
  for (uint i = 0u; same && i < 2u; ++i) same = keptWord(old, keptContents(old, voxel) + i) == keptWord(now, keptContents(now, here) + i);
  if (same) atomicAnd(changed[word], ~(1u << (bit & 31u)));
  else atomicOr(changed[word], 1u << (bit & 31u));
}
