#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Every face is a piece of its own before connect.comp joins them.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) writeonly buffer Parents { uint parents[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s < push.faceCount) parents[s] = s;
}
