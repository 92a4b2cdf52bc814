#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Voxels met by more triangles than are worth a list have none; and 0 after the last voxel, for the scan.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Counts { uint counts[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer First { uint first[]; };
layout(push_constant, scalar) uniform Push {
  uint voxelCount;
  uint most;
};

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel > voxelCount) return;
  uint count = voxel < voxelCount ? counts[voxel] : 0u;
  first[voxel] = count <= most ? count : 0u;
}
