#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Σ popcount of the occupancy: one atomic a workgroup.
#include "shared/dispatch.glsl"

layout(local_size_x = 256) in;
layout(set = 0, binding = 0, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 1, scalar) buffer Count { uint voxelCount; };
layout(push_constant, scalar) uniform Push { uint brickCount; };

shared uint groupCount;

void main() {
  if (gl_LocalInvocationIndex == 0u) groupCount = 0u;
  barrier();
  uint brick = radivoxItemIndex();
  if (brick < brickCount) {
    uint voxels = uint(bitCount(occupancy[brick].x)) + uint(bitCount(occupancy[brick].y));
    if (voxels != 0u) atomicAdd(groupCount, voxels);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && groupCount != 0u) atomicAdd(voxelCount, groupCount);
}
