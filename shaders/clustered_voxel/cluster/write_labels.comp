#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The dense cluster id of every face.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Lowest { uint lowest[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Ranks { uint ranks[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Labels { uint labels[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s < push.faceCount) labels[s] = ranks[lowest[pieces[s]]];
}
