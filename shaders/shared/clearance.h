// The clearance of a voxel: an empty box around it, which a ray may leave in one step. A word per voxel of the grid with a rim of one voxel around it;
// a row's last rim voxel is the next row's first, and so for the rows of a slice.
// Without kClearanceOpen: the voxel's compact index + 1 if it has faces, 0 if it is rim. With it, per direction f (as faces are numbered), how many
// voxels the box goes on beyond this one; all voxels of the box are in the grid and without faces.
#ifndef RADIVOX_SHADERS_SHARED_CLEARANCE_H
#define RADIVOX_SHADERS_SHARED_CLEARANCE_H
#include "types.h"
#ifdef __cplusplus
#define RADIVOX_CLEARANCE_FUNCTION inline
#else
#define RADIVOX_CLEARANCE_FUNCTION
#endif
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kClearanceOpen = 0x80000000u;
RADIVOX_CONST uint kClearanceBits = 5u;   // a direction, the first lowest
RADIVOX_CONST uint kMostClearance = 31u;  // voxels

/// Word of a voxel, given its coordinate + 1.
RADIVOX_CLEARANCE_FUNCTION uint clearanceIndex(uvec3 rimmed, uvec3 size) {
  return rimmed.x + (size.x + 1u) * (rimmed.y + (size.y + 1u) * rimmed.z);
}
/// The same in the sums that clearance is made from, where rims are not shared.
RADIVOX_CLEARANCE_FUNCTION uint clearanceSumIndex(uvec3 rimmed, uvec3 size) {
  return rimmed.x + (size.x + 2u) * (rimmed.y + (size.y + 2u) * rimmed.z);
}

RADIVOX_SHARED_END
#endif
