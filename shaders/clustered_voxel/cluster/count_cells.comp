#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Which dominant directions occur in each cell: each gets a seed.
#include "clustered_voxel/cluster/cluster_common.glsl"
#define RADIVOX_BIND_FACES 0
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 1, scalar) readonly buffer Cells { uint slotCells[]; };
layout(set = 0, binding = 2, scalar) buffer FaceCells { uint faceCells[]; };  // slot → cell
layout(set = 0, binding = 3, scalar) buffer CellMasks { uint cellMasks[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint cell = slotCells[faceCells[s]];
  faceCells[s] = cell;
  atomicOr(cellMasks[cell], 1u << dominantDirection(decodeNormal(faceAt(s).normal)));
}
