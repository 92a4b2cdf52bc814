#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Lists the faces by cell, and by direction within each, so that neighbouring lanes look at the same seeds. Among faces of one seed the
// order is any: each decides for itself.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 1, scalar) readonly buffer SeedStarts { uint seedStarts[]; };
layout(set = 0, binding = 2, scalar) buffer Cursors { uint cursors[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Sorted { uint sorted[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint seed = seedLabels[s];
  sorted[seedStarts[seed] + atomicAdd(cursors[seed], 1u)] = s;
}
