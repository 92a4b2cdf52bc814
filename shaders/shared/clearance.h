// The clearance of a voxel: the half-size of the empty cube around it. A byte per voxel of the grid with a rim of one voxel around it,
// rows along x padded to whole words. 0: the voxel has faces, or is rim. c > 0: every voxel nearer than c along every axis has no
// faces and is in the grid, so a ray may leave that cube in one step; at most kMaxClearance, which may understate it.
#ifndef RADIVOX_SHADERS_SHARED_CLEARANCE_H
#define RADIVOX_SHADERS_SHARED_CLEARANCE_H
#include "types.h"
#ifdef __cplusplus
#define RADIVOX_CLEARANCE_FUNCTION inline
#else
#define RADIVOX_CLEARANCE_FUNCTION
#endif
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kMaxClearance = 48u;

RADIVOX_CLEARANCE_FUNCTION uint clearanceRowBytes(uvec3 size) { return (size.x + 5u) & ~3u; }
/// Byte of a voxel, given its coordinate + 1.
RADIVOX_CLEARANCE_FUNCTION uint clearanceIndex(uvec3 rimmed, uvec3 size) {
  return rimmed.x + clearanceRowBytes(size) * (rimmed.y + (size.y + 2u) * rimmed.z);
}

RADIVOX_SHARED_END
#endif
