// voxelize: one bit a voxel.
#include "clustered_voxel/voxelize/triangle.glsl"

layout(set = 0, binding = 4, scalar) buffer Occupancy { uint occupancyWords[]; };  // uvec2 × B

void visitVoxel(Triangle t, ivec3 turned) {
  uvec3 voxel = uvec3(turnBack(turned, t.axis));
  uint bit = bitOf(voxel);
  uint word = 2u * brickOf(voxel, grid.bricks) + (bit >> 5);
  uint flag = 1u << (bit & 31u);
  // Most voxels are met by several triangles; a stale read only costs an atomic that changes nothing.
  if ((occupancyWords[word] & flag) == 0u) atomicOr(occupancyWords[word], flag);
}
