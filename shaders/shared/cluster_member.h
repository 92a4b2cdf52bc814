// A member of a cluster (clustered_voxel.members): a face, and how much it counts in means over the cluster (clustered_voxel.shares), as a
// share of what the most seen member counts.
//   face | share << 24, in steps of 1/255; 0 throughout: not known, areas count
#ifndef RADIVOX_SHADERS_SHARED_CLUSTER_MEMBER_H
#define RADIVOX_SHADERS_SHARED_CLUSTER_MEMBER_H
#include "functions.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kMostShare = 255u;

RADIVOX_FUNCTION uint memberFace(uint member) { return member & 0x00ffffffu; }
RADIVOX_FUNCTION uint memberShare(uint member) { return member >> 24; }
// weight / greatest in steps, to the nearest; greatest ≥ weight, > 0.
RADIVOX_FUNCTION uint memberWith(uint face, uint weight, uint greatest) {
  uint shift = greatest >= 0x400000u ? (greatest >= 0x40000000u ? 10u : 8u) : 0u;
  uint least = greatest >> shift;
  return face | (((weight >> shift) * kMostShare + least / 2u) / least) << 24;
}

RADIVOX_SHARED_END
#endif
