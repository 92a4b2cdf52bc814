// triangles: how many triangles meet each voxel, then which.
#include "clustered_voxel/voxelize/triangle.glsl"

layout(constant_id = 0) const bool kFill = false;

layout(set = 0, binding = 4, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Rank { uint brickRank[]; };
layout(set = 0, binding = 6, scalar) readonly buffer First { uint first[]; };  // fill only
layout(set = 0, binding = 7, scalar) buffer Counts { uint counts[]; };         // count: per voxel; fill: the next free place of each voxel
layout(set = 0, binding = 8, scalar) writeonly buffer Ids { uint ids[]; };     // fill only

void visitVoxel(Triangle t, ivec3 turned) {
  uvec3 voxel = uvec3(turnBack(turned, t.axis));
  uint brick = brickOf(voxel, grid.bricks);
  uint index = brickRank[brick] + countBitsBelow(occupancy[brick], bitOf(voxel));  // overlapped, so occupied
  if (!kFill)
    atomicAdd(counts[index], 1u);
  else if (first[index + 1u] > first[index])
    ids[atomicAdd(counts[index], 1u)] = t.id;
}
