#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Voxels of each brick, for the scan that ranks them.
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { uint brickCount; };

void main() {
  uint brick = radivoxItemIndex();
  if (brick < brickCount) counts[brick] = countBits(occupancy[brick]);
}
