#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// After each assignment: go on, or let the rest of the iterations do nothing.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, scalar) buffer Control { ClusterControl control; };

void main() {
  if (control.cellGroups.x == 0u) return;
  control.iterations += 1u;
  if (control.changed <= push.changeLimit || control.iterations >= push.iterationLimit) {
    // Seeds stay as the faces saw them: they are what the faces agreed with.
    control.cellGroups = uvec3(0u);
    control.seedGroups = uvec3(0u);
  } else {
    control.changed = 0u;
  }
}
