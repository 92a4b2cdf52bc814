#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sums of the members of each seed, in integers: their order does not matter. Positions are relative to the middle of the seed's home
// cell, from which no member is farther than one and a half cells; units are chosen so that no sum wraps (ClusterPush).
#include "clustered_voxel/cluster/cluster_common.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 2, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 3, scalar) readonly buffer SeedHomes { uint seedHomes[]; };
layout(set = 0, binding = 4, scalar) buffer Moments { int moments[]; };      // 4 a seed: Σ normal, members
layout(set = 0, binding = 5, scalar) buffer Positions { int positions[]; };  // 3 a seed

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint seed = seedLabels[s];
  if (seed == kNone) return;
  Face face = faces[s];
  uvec3 voxel = voxelCoordinate(face.key >> 3);
  uvec3 inside = uvec3(face.position & 1023u, (face.position >> 10) & 1023u, (face.position >> 20) & 1023u);
  ivec3 middle = ivec3(unpackVoxel(seedHomes[seed]) * (push.spacing * 1023u) + (push.spacing * 1023u) / 2u);
  ivec3 offset = ivec3(voxel * 1023u + inside) - middle;
  ivec3 position = (offset + ((1 << push.positionShift) >> 1)) >> push.positionShift;
  vec3 n = decodeNormal(face.normal);
  precise vec3 scaled = n * push.normalUnit + 0.5;
  ivec3 normal = ivec3(floor(scaled));
  for (int k = 0; k < 3; ++k) {
    atomicAdd(moments[4u * seed + k], normal[k]);
    atomicAdd(positions[3u * seed + k], position[k]);
  }
  atomicAdd(moments[4u * seed + 3u], 1);
}
