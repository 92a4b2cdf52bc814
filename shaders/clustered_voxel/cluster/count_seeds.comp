#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Seeds of each cell. Cells past the last one have none.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer CellMasks { uint cellMasks[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer FirstSeeds { uint firstSeeds[]; };

void main() {
  uint cell = radivoxItemIndex();
  if (cell < push.faceCount) firstSeeds[cell] = uint(bitCount(cellMasks[cell]));
}
