#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One flag a face: it is the lowest of its cluster. Their scan numbers the clusters.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Lowest { uint lowest[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Flags { uint flags[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s < push.faceCount) flags[s] = lowest[pieces[s]] == s ? 1u : 0u;
}
