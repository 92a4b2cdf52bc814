#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Joins faces of the same seed whose voxels touch (26 neighbours, or the same voxel), one lane a voxel. Faces that no seed accepted are
// left to connect_orphans.comp.
#include "clustered_voxel/cluster/cluster_common.glsl"
#include "clustered_voxel/structure.glsl"
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
    uint other = voxelIndex(coordinate + ivec3(step % 3u, (step / 3u) % 3u, step / 9u) - 1);
    if (other == kNone) continue;
    uint otherBegin = firstFaces[other];
    uint otherEnd = otherBegin + uint(bitCount(faceMasks[other]));
    uint last = kNone;
    for (uint b = otherBegin; b < otherEnd; ++b) {
      uint otherLabel = seedLabels[b];
      if (otherLabel == last) continue;
      last = otherLabel;
      uint match = kNone;
      for (uint f = 0; f < kFaceCount; ++f)
        if (match == kNone && label[f] == otherLabel) match = begin + f;
      if (otherLabel != kNone && match != kNone) unite(match, b);
    }
  }
}
