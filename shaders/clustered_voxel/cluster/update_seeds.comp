#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Each seed moves to the mean of its members; one that lost them all stays where it is. Notes which seeds moved at all.
#define RADIVOX_BIND_HOMES 0
#define RADIVOX_BIND_MOMENTS 1
#define RADIVOX_BIND_POSITIONS 2
#include "clustered_voxel/cluster/seed_sums.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 3, scalar) buffer Seeds { Seed seeds[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Control { ClusterControl control; };

void main() {
  uint i = radivoxItemIndex();
  if (i >= control.seedCount) return;
  bool isFirst = control.iterations == 0u;
  Seed seed = Seed(vec3(0.0), vec3(0.0));
  if (!isFirst) {
    seed.position = seeds[i].position;
    seed.normal = seeds[i].normal;
  }
  Seed old = seed;
  int memberCount = moments[4u * i + 3u];
  if (memberCount > 0) {
    vec3 sum = vec3(moments[4u * i], moments[4u * i + 1u], moments[4u * i + 2u]);
    vec3 moved = vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
    precise float share = preciseReciprocal(float(memberCount)) * float(1u << push.positionShift);
    precise vec3 position = (vec3(middleOfHome(i)) + moved * share) * (1.0 / 1023.0);
    seed.position = position;
    // Below one unit the normals cancel and their direction means nothing: the old one stays.
    precise float squared = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    if (squared >= 1.0) {
      precise float scale = preciseInverseSqrt(squared);
      precise vec3 normal = sum * scale;
      seed.normal = normal;
    }
    seeds[i] = seed;
  }
  bool hasChanged = isFirst || seed.position != old.position || seed.normal != old.normal;
  seedHomes[i] = (seedHomes[i] & ~kSeedMoved) | (hasChanged ? kSeedMoved : 0u);
}
