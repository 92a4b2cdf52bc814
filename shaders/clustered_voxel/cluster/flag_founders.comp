#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One flag a face: it is the founder of its seed cell. Their scan numbers the cells in order of their lowest face.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Founders { uint slotFounders[]; };
layout(set = 0, binding = 1, scalar) readonly buffer FaceCells { uint faceCells[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Flags { uint flags[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  flags[s] = slotFounders[faceCells[s]] == s ? 1u : 0u;
}
