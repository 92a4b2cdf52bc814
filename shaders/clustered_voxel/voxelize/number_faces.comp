#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Faces of each voxel, and 0 after the last, for the scan that numbers them.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer FaceMasks { uint faceMasks[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer FaceCounts { uint faceCounts[]; };
layout(push_constant, scalar) uniform Push { uint voxelCount; };

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel <= voxelCount) faceCounts[voxel] = voxel < voxelCount ? uint(bitCount(faceMasks[voxel])) : 0u;
}
