// Sums of the members of each seed, in integers: their order does not matter, and members can be taken out again. Positions are
// relative to the middle of the seed's home cell, from which no member is farther than one and a half cells; units are chosen so that
// no sum wraps (ClusterPush). Define RADIVOX_BIND_HOMES, _MOMENTS and _POSITIONS before.
#ifndef RADIVOX_CLUSTER_SEED_SUMS_GLSL
#define RADIVOX_CLUSTER_SEED_SUMS_GLSL
#include "clustered_voxel/cluster/cluster_common.glsl"

layout(set = 0, binding = RADIVOX_BIND_HOMES, scalar) buffer SeedHomes { uint seedHomes[]; };    // packed cell, kSeedMoved
layout(set = 0, binding = RADIVOX_BIND_MOMENTS, scalar) buffer Moments { int moments[]; };       // 4 a seed: Σ normal, members
layout(set = 0, binding = RADIVOX_BIND_POSITIONS, scalar) buffer Positions { int positions[]; }; // 3 a seed

const uint kSeedMoved = 0x80000000u;  // in the last update

bool hasMoved(uint seed) { return (seedHomes[seed] & kSeedMoved) != 0u; }

// In 1/1023 voxel.
uvec3 middleOfHome(uint seed) {
  uvec3 home = unpackVoxel(seedHomes[seed] & ~kSeedMoved);
  return home * (push.spacing * 1023u) + (push.spacing * 1023u) / 2u;
}

// sign: 1 adds the face, −1 takes it out.
void addMember(uint seed, Face face, uvec3 voxel, vec3 n, int sign) {
  uvec3 inside = uvec3(face.position & 1023u, (face.position >> 10) & 1023u, (face.position >> 20) & 1023u);
  ivec3 offset = ivec3(voxel * 1023u + inside) - ivec3(middleOfHome(seed));
  ivec3 position = (offset + ((1 << push.positionShift) >> 1)) >> push.positionShift;
  precise vec3 scaled = n * push.normalUnit + 0.5;
  ivec3 normal = ivec3(floor(scaled));
  for (int k = 0; k < 3; ++k) {
    atomicAdd(moments[4u * seed + k], sign * normal[k]);
    atomicAdd(positions[3u * seed + k], sign * position[k]);
  }
  atomicAdd(moments[4u * seed + 3u], sign);
}

#endif
