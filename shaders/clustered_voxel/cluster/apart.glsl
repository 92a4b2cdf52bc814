// Clusters must not reach through walls: what falls on one side would light the other. Include after structure.glsl.
#ifndef RADIVOX_CLUSTERED_VOXEL_CLUSTER_APART_GLSL
#define RADIVOX_CLUSTERED_VOXEL_CLUSTER_APART_GLSL
// In doubt a wall: to part what belongs together costs an entry or two, to join what does not is a leak.
#define RADIVOX_WALL_SLACK 0.0
#define RADIVOX_WALL_AREA 0.01
#define RADIVOX_WALL_COSINE 0.5
#include "clustered_voxel/walls.glsl"

// Does a wall stand between two faces, of voxels that touch, as one of them sees it?
bool areApart(uint a, ivec3 aCoordinate, uint b, ivec3 bCoordinate) {
  if (aCoordinate == bCoordinate) return false;
  precise vec3 from = vec3(aCoordinate) + decodePosition(faces[a].position);
  precise vec3 to = vec3(bCoordinate) + decodePosition(faces[b].position);
  uint aVoxel = faces[a].key >> 3;
  uint bVoxel = faces[b].key >> 3;
  // Mostly neither voxel has a face across the way, and nothing more need be read.
  uint mask = faceMasks[aVoxel] | faceMasks[bVoxel];
  bvec3 walled = greaterThanEqual(abs(to - from), vec3(RADIVOX_WALL_STEP));
  walled = bvec3(walled.x && (mask & 3u) != 0u, walled.y && (mask & 12u) != 0u, walled.z && (mask & 48u) != 0u);
  if (!any(walled)) return false;
  return wallBetween(aCoordinate, aVoxel, from, bCoordinate, bVoxel, to, stepAhead(decodeNormal(faces[a].normal))) ||
         wallBetween(bCoordinate, bVoxel, to, aCoordinate, aVoxel, from, stepAhead(decodeNormal(faces[b].normal)));
}

#endif
