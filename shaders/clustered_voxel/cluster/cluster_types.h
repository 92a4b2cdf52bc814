// What the dispatches of clustered_voxel.cluster share: push constants and the control block.
#ifndef RADIVOX_SHADERS_CLUSTERED_VOXEL_CLUSTER_TYPES_H
#define RADIVOX_SHADERS_CLUSTERED_VOXEL_CLUSTER_TYPES_H
#include "../../shared/types.h"
RADIVOX_SHARED_BEGIN

struct ClusterPush {
  uint faceCount;
  uint voxelCount;
  uint spacing;        // S, voxels a side of a seed cell
  uint hashSize;       // slots of the cell table, at least twice the number of faces
  float spaceScale;    // space weight / S²
  float normalScale;   // normal weight / (1 − cos angle)
  float cosAngle;      // faces whose normal is farther from a seed's are rejected
  float sinAngle;
  uint positionShift;  // sums of positions are in units of 2^shift / 1023 voxels, so that they cannot wrap
  float normalUnit;    // sums of normals are in units of 1 / normalUnit, likewise
  uint orphanBins;     // direction bins a side of each cube face; two normals of one bin are within the angle
  uint iterationLimit;
  uint changeLimit;    // stop when no more faces than this changed
  uint mergeLimit;     // clusters of at most this many faces look for a neighbour to join, ≤ 3
};

// Indirect dispatch arguments of the iterations come first; they are zeroed when the clusters stand still.
struct ClusterControl {
  uvec3 cellGroups;
  uvec3 seedGroups;
  uint cellCount;
  uint cellCountHigh;  // Scan's totals are two words
  uint seedCount;
  uint seedCountHigh;
  uint changed;
  uint iterations;
  uint orphanCount;
  uint pieceCount;
  uint mergedCount;
};

RADIVOX_CONST uint kClusterGroup = 64u;
RADIVOX_CONST uint kMostMergeFaces = 3u;

RADIVOX_SHARED_END
#endif
