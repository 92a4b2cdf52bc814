#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Distinct columns of each row of the cluster matrix.
#include "clustered_voxel/visibility/transfer_columns.glsl"
layout(set = 0, binding = 5, scalar) writeonly buffer Counts { uint counts[]; };  // C + 1, scanned to row starts

shared uint columnCount;

void main() {
  uint c = radivoxGroupIndex();
  if (c >= push.clusterCount) return;  // the whole group
  uint lane = gl_LocalInvocationID.x;
  clearColumns();
  if (lane == 0u) columnCount = 0u;
  uvec2 range = membersOf(c);
  for (uint window = 0u; window < push.clusterCount; window += kWindow) {
    findColumns(range, window);
    uint found = countOwnColumns();
    if (found > 0u) atomicAdd(columnCount, found);
    forgetColumns();
  }
  if (lane == 0u) counts[c] = columnCount;
}
