#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Each seed moves to the mean of its members; one that lost them all stays where it is. Clears the sums for the next round.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer SeedHomes { uint seedHomes[]; };
layout(set = 0, binding = 1, scalar) buffer Moments { int moments[]; };
layout(set = 0, binding = 2, scalar) buffer Positions { int positions[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Seeds { Seed seeds[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Control { ClusterControl control; };

void main() {
  uint seed = radivoxItemIndex();
  if (seed >= control.seedCount) return;
  int memberCount = moments[4u * seed + 3u];
  if (memberCount == 0) return;
  vec3 sum = vec3(moments[4u * seed], moments[4u * seed + 1u], moments[4u * seed + 2u]);
  vec3 moved = vec3(positions[3u * seed], positions[3u * seed + 1u], positions[3u * seed + 2u]);
  for (uint k = 0; k < 4; ++k) moments[4u * seed + k] = 0;
  for (uint k = 0; k < 3; ++k) positions[3u * seed + k] = 0;

  vec3 middle = vec3(unpackVoxel(seedHomes[seed]) * (push.spacing * 1023u) + (push.spacing * 1023u) / 2u);
  precise float share = preciseReciprocal(float(memberCount)) * float(1u << push.positionShift);
  precise vec3 position = (middle + moved * share) * (1.0 / 1023.0);
  seeds[seed].position = position;
  // Units of n · normalUnit: below one unit the members cancel and the direction means nothing; the seed keeps its old one.
  precise float squared = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
  if (squared >= 1.0) {
    precise float scale = preciseInverseSqrt(squared);
    precise vec3 normal = sum * scale;
    seeds[seed].normal = normal;
  }
}
