#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The occupied voxels in the order of their index: one lane a brick.
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 3, scalar) writeonly buffer Voxels { uint voxels[]; };

void main() {
  uint brick = radivoxItemIndex();
  if (brick >= grid.brickCount) return;
  uvec2 word = brickBits(brick);
  if (word == uvec2(0u)) return;
  uint voxel = rankOf(brick);
  uvec3 low = 4u * brickCoordinate(brick, grid.bricks);
  for (uint half_ = 0u; half_ < 2u; ++half_) {
    for (uint bits = word[half_]; bits != 0u; bits &= bits - 1u) {
      uint bit = 32u * half_ + uint(findLSB(bits));
      voxels[voxel++] = packVoxel(low + bitCoordinate(bit));
    }
  }
}
