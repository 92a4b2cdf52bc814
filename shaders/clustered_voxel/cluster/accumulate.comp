#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The first sums: every face in the seed of its own cell. Later ones follow from the changes (assign.comp).
#define RADIVOX_BIND_HOMES 3
#define RADIVOX_BIND_MOMENTS 4
#define RADIVOX_BIND_POSITIONS 5
#include "clustered_voxel/cluster/seed_sums.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 2, scalar) readonly buffer SeedLabels { uint seedLabels[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  Face face = faceAt(s);
  addMember(seedLabels[s], face, voxelCoordinate(face.key >> 3), decodeNormal(face.normal), 1);
}
