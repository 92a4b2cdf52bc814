// Clusters must not reach through walls: what falls on one side would light the other. Include after structure.glsl.
#ifndef RADIVOX_CLUSTERED_VOXEL_CLUSTER_APART_GLSL
#define RADIVOX_CLUSTERED_VOXEL_CLUSTER_APART_GLSL
// In doubt a wall: to part what belongs together costs an entry or two, to join what does not is a leak.
#define RADIVOX_WALL_SLACK 0.0
#define RADIVOX_WALL_AREA 0.01
#define RADIVOX_WALL_COSINE 0.5
#include "clustered_voxel/walls.glsl"

// Does a wall stand between two faces, of voxels that touch, as one of them sees it? The same as wallBetween() from each to the other, but in one loop
// over the faces there are that may be walls: mostly none, and CPU devices execute all that is not in a loop.
bool areApart(uint a, ivec3 aCoordinate, uint b, ivec3 bCoordinate) {
  Face aFace = faceAt(a), bFace = faceAt(b);
  uint aVoxel = aFace.key >> 3, bVoxel = bFace.key >> 3;
  precise vec3 from = vec3(aCoordinate) + decodePosition(aFace.position);
  precise vec3 to = vec3(bCoordinate) + decodePosition(bFace.position);
  vec3 step = to - from;
  uint aMask = faceMask(aVoxel), bMask = faceMask(bVoxel);
  // Four bits an axis: walls that look back at `a`, in its voxel or the other's, then those that look back at `b`.
  uint left = 0u;
  for (uint k = 0u; k < 3u; ++k) {
    uint f = 2u * k + (step[k] > 0.0 ? 1u : 0u);
    uint backs = ((aMask >> f) & 1u) | ((bMask >> f) & 1u) << 1u | ((aMask >> (f ^ 1u)) & 1u) << 2u | ((bMask >> (f ^ 1u)) & 1u) << 3u;
    left |= abs(step[k]) >= RADIVOX_WALL_STEP ? backs << (4u * k) : 0u;
  }
  if (aCoordinate == bCoordinate) left = 0u;
  ivec3 aAhead = stepAhead(decodeNormal(aFace.normal)), bAhead = stepAhead(decodeNormal(bFace.normal));
  bool wall = false;
  for (; left != 0u && !wall; left &= left - 1u) {
    uint bit = uint(findLSB(left));
    uint k = bit >> 2;
    bool inA = (bit & 1u) == 0u, fromA = (bit & 2u) == 0u;
    uint f = 2u * k + ((step[k] > 0.0) == fromA ? 1u : 0u);
    wall = wallAt(inA ? aCoordinate : bCoordinate, inA ? aVoxel : bVoxel, f, from[k], to[k], fromA ? aAhead : bAhead);
  }
  return wall;
}

#endif
