#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Gives every face to the seed of its own cell and dominant direction, whose first centre is then their mean.
#include "clustered_voxel/cluster/cluster_common.glsl"
#define RADIVOX_BIND_FACES 0
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 1, scalar) readonly buffer FaceCells { uint faceCells[]; };
layout(set = 0, binding = 2, scalar) readonly buffer CellMasks { uint cellMasks[]; };
layout(set = 0, binding = 3, scalar) readonly buffer FirstSeeds { uint firstSeeds[]; };
layout(set = 0, binding = 4, scalar) readonly buffer CellKeys { uint cellKeys[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer SeedHomes { uint seedHomes[]; };
layout(set = 0, binding = 7, scalar) buffer SeedStarts { uint seedStarts[]; };  // counts, so far

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint cell = faceCells[s];
  uint direction = dominantDirection(decodeNormal(faceAt(s).normal));
  uint seed = firstSeeds[cell] + uint(bitCount(cellMasks[cell] & ((1u << direction) - 1u)));
  seedLabels[s] = seed;
  seedHomes[seed] = cellKeys[cell];  // the same word from every face of the seed
  atomicAdd(seedStarts[seed], 1u);
}
