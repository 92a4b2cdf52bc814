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
layout(set = 0, binding = 7, scalar) readonly buffer SeedLabels { uint seedLabels[]; };

void main() {
  uint v = radivoxItemIndex();
  if (v >= push.voxelCount) return;
  uint mask = faceMasks[v];
  if (mask == 0u) return;
  uint begin = firstFaces[v];
  uint count = uint(bitCount(mask));
  uint label[kFaceCount];
  for (uint f = 0; f < kFaceCount; ++f) label[f] = f < count ? seedLabels[begin + f] : kNone;
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
    uint otherBegin = firstFaces[other];
    uint otherEnd = otherBegin + uint(bitCount(faceMasks[other]));
    // Pairs are numbered 6 · (the other's face) + our face. Lanes look for their next pair each on its own and then look for walls together.
    uint pair = 0u;
    uint pairs = kFaceCount * (otherEnd - otherBegin);
    while (true) {
      while (pair < pairs) {
        uint own = label[pair % kFaceCount];
        if (own != kNone && own == seedLabels[otherBegin + pair / kFaceCount]) break;
        ++pair;
      }
      if (pair >= pairs) break;
      uint a = begin + pair % kFaceCount;
      uint b = otherBegin + pair / kFaceCount;
      bool joins = !areApart(a, coordinate, b, otherCoordinate);
      if (joins) unite(a, b);
      // This voxel's others of the seed are one with `a` already.
      pair = joins ? (pair / kFaceCount + 1u) * kFaceCount : pair + 1u;
    }
  }
}
