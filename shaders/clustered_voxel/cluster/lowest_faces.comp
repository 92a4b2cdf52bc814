#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The lowest face of every piece; after merging that need not be its root.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 1, scalar) buffer Lowest { uint lowest[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s < push.faceCount) atomicMin(lowest[pieces[s]], s);
}
