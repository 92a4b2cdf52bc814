#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Founders give their cell its number; the table then maps a key to the cell's number instead of its founder.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Keys { uint slotKeys[]; };
layout(set = 0, binding = 1, scalar) buffer Cells { uint slotCells[]; };
layout(set = 0, binding = 2, scalar) readonly buffer FaceCells { uint faceCells[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Ranks { uint ranks[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer CellKeys { uint cellKeys[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Control { ClusterControl control; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  // The rank rises behind each founder, the last one's behind the end.
  uint next = s + 1u < push.faceCount ? ranks[s + 1u] : control.cellCount;
  if (next == ranks[s]) return;
  uint slot = faceCells[s];
  slotCells[slot] = ranks[s];
  cellKeys[ranks[s]] = slotKeys[slot];
}
