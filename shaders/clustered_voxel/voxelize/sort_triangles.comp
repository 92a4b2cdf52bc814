#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Puts each voxel's triangles in ascending order, so that the lists do not depend on timing. Lists are short: insertion sort.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer First { uint first[]; };
layout(set = 0, binding = 1, scalar) buffer Ids { uint ids[]; };
layout(push_constant, scalar) uniform Push { uint voxelCount; };

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= voxelCount) return;
  uint begin = first[voxel];
  uint end = first[voxel + 1u];
  for (uint i = begin + 1u; i < end; ++i) {
    uint id = ids[i];
    uint at = i;
    for (; at > begin && ids[at - 1u] > id; --at) ids[at] = ids[at - 1u];
    ids[at] = id;
  }
}
