#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Faces that no seed accepted join those of their own seed cell and direction bin that touch them, no wall between. One lane a face; few have work.
#include "clustered_voxel/cluster/cluster_common.glsl"
#include "clustered_voxel/structure.glsl"
#include "clustered_voxel/cluster/apart.glsl"
#define RADIVOX_BIND_PARENTS 9
#include "clustered_voxel/cluster/union_find.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 6, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 7, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 8, scalar) readonly buffer FaceCells { uint faceCells[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount || seedLabels[s] != kNone) return;
  uint bin = directionBin(decodeNormal(faceAt(s).normal));
  ivec3 coordinate = ivec3(unpackVoxel(voxels[faceAt(s).key >> 3]));
  for (uint step = 0; step < 27u; ++step) {
    ivec3 otherCoordinate = coordinate + ivec3(step % 3u, (step / 3u) % 3u, step / 9u) - 1;
    uint other = voxelIndex(otherCoordinate);
    if (other == kNone) continue;
    uint begin = firstFace(other);
    uint end = min(begin + uint(bitCount(faceMask(other))), s);  // each pair is seen to by its higher face
    for (uint b = begin; b < end; ++b) {
      if (seedLabels[b] != kNone || faceCells[b] != faceCells[s]) continue;
      if (directionBin(decodeNormal(faceAt(b).normal)) == bin && !areApart(s, coordinate, b, otherCoordinate)) unite(s, b);
    }
  }
}
