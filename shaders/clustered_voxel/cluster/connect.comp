#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Joins faces of the same seed whose voxels touch (26 neighbours, or the same voxel) and between which no wall stands, one lane a voxel. Faces
// that no seed accepted are left to connect_orphans.comp.
#include "clustered_voxel/cluster/cluster_common.glsl"
#include "clustered_voxel/structure.glsl"
#include "clustered_voxel/cluster/apart.glsl"
#define RADIVOX_BIND_PARENTS 8
#include "clustered_voxel/cluster/union_find.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 6, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 7) uniform usamplerBuffer seedLabelTexels;
uint seedLabel(uint s) { return texelFetch(seedLabelTexels, int(s)).x; }

void main() {
  uint v = radivoxItemIndex();
  if (v >= push.voxelCount) return;
  uint mask = faceMask(v);
  if (mask == 0u) return;
  uint begin = firstFace(v);
  uint count = uint(bitCount(mask));
  uint label[kFaceCount];
  for (uint f = 0; f < kFaceCount; ++f) label[f] = f < count ? seedLabel(begin + f) : kNone;
  // The first face of each seed stands for the others of this voxel once they are joined to it.
  for (uint f = 1; f < count; ++f) {
    uint same = f;
    for (uint g = kFaceCount; g > 0u; --g)
      if (g - 1u < f && label[g - 1u] == label[f]) same = g - 1u;
    if (same != f && label[f] != kNone) unite(begin + f, begin + same);
  }
  ivec3 coordinate = ivec3(unpackVoxel(voxels[v]));
  // Half of the neighbourhood: the other half sees us.
  for (uint step = 0; step < 13u; ++step) {
    ivec3 otherCoordinate = coordinate + ivec3(step % 3u, (step / 3u) % 3u, step / 9u) - 1;
    uint other = voxelIndex(otherCoordinate);
    if (other == kNone) continue;
    uint otherBegin = firstFace(other);
    uint otherEnd = otherBegin + uint(bitCount(faceMask(other)));
    // Pairs of one seed, six bits a face of the other's, a bit for each of ours. Lanes take their next pair each on its own and look for walls together.
    uvec2 pairs = uvec2(0u);
    for (uint o = otherBegin; o < otherEnd; ++o) {
      uint seed = seedLabel(o);
      uint same = 0u;
      for (uint f = 0; f < kFaceCount; ++f) same |= seed != kNone && label[f] == seed ? 1u << f : 0u;
      uint at = kFaceCount * (o - otherBegin);
      pairs |= at < 30u ? uvec2(same << at, 0u) : uvec2(0u, same);
    }
    while (pairs != uvec2(0u)) {
      uint pair = pairs.x != 0u ? uint(findLSB(pairs.x)) : 30u + uint(findLSB(pairs.y));
      uint f = pair % kFaceCount;
      uint first = pair - f;
      uint a = begin + f;
      uint b = otherBegin + first / kFaceCount;
      bool joins = !areApart(a, coordinate, b, otherCoordinate);
      if (joins) unite(a, b);
      // This voxel's others of the seed are one with `a` already.
      uint done = joins ? 0x3fu : 1u << f;
      pairs &= ~(first < 30u ? uvec2(done << first, 0u) : uvec2(0u, done));
    }
  }
}
