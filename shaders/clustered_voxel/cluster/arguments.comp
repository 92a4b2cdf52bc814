#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Dispatch arguments of the iterations: a group a cell, a lane a seed.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, scalar) buffer Control { ClusterControl control; };

uvec3 foldGroups(uint groups) {
  const uint kRow = 32768u;
  return groups <= kRow ? uvec3(groups, 1u, 1u) : uvec3(kRow, (groups + kRow - 1u) / kRow, 1u);
}

void main() {
  control.cellGroups = foldGroups(control.cellCount);
  control.seedGroups = foldGroups((control.seedCount + kClusterGroup - 1u) / kClusterGroup);
}
