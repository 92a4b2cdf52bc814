#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Middle and area of the piece of each listed triangle in its voxel: where rays of the voxel's faces start. One lane an entry.
#include "clustered_voxel/voxelize/piece.glsl"
#include "shared/dispatch.glsl"
#include "shared/listed_triangle.h"
layout(local_size_x = 64) in;
layout(set = 0, binding = 3, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 4, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 5, scalar) readonly buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer Pieces { uvec2 pieces[]; };
layout(push_constant, scalar) uniform Push {
  uint voxelCount;
  uint entryCount;
};

// The last voxel whose list does not begin after `entry`; those without a list share their place with the next and are passed over.
uint voxelOfEntry(uint entry) {
  uint low = 0u, high = voxelCount;
  while (high - low > 1u) {
    uint middle = (low + high) >> 1;
    if (triangleFirst[middle] <= entry)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void main() {
  uint entry = radivoxItemIndex();
  if (entry >= entryCount) return;
  uvec3 voxel = unpackVoxel(voxels[voxelOfEntry(entry)]);
  Triangle t = loadTriangle(listedTriangle(triangleIds[entry]));
  Piece piece = measurePiece(t, turn(ivec3(voxel), t.axis));
  pieces[entry] = uvec2(encodePosition(turnBack(piece.middle, t.axis)), floatBitsToUint(max(piece.area, 0.0)));
}
