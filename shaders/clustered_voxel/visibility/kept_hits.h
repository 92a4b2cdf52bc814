// What clustered_voxel.visibility keeps from one run to the next (visibility.keep): what every ray hit, and enough of the voxels to tell which have
// changed. One buffer of words, reached by its address:
//   voxels    V      packed coordinates
//   contents  2 V    hash of all that a ray can meet in the voxel
//   faces     F      keys; in the run after, each old face's new index, or kNone
//   hits      F · M  what each ray hit (visibility.h)
#ifndef RADIVOX_CLUSTERED_VOXEL_KEPT_HITS_H
#define RADIVOX_CLUSTERED_VOXEL_KEPT_HITS_H
#include "../../shared/voxel_codec.h"
RADIVOX_SHARED_BEGIN

struct KeptHits {
  uvec2 address;
  uint voxelCount;
  uint faceCount;
};

RADIVOX_FUNCTION uint keptContents(KeptHits kept, uint voxel) { return kept.voxelCount + 2u * voxel; }
RADIVOX_FUNCTION uint keptFace(KeptHits kept, uint face) { return 3u * kept.voxelCount + face; }
RADIVOX_FUNCTION uint keptHit(KeptHits kept, uint face, uint rayCount, uint ray) {
  return 3u * kept.voxelCount + kept.faceCount + face * rayCount + ray;
}

// Boxes around all voxels that have changed: the coordinates of their least and greatest voxels.
RADIVOX_CONST uint kMostChangedBoxes = 8u;
struct ChangedBox {
  vec3 least;
  vec3 greatest;
};
// A ray runs from somewhere in one voxel to somewhere in another, at most half a voxel beside the line between their middles; 26-connected lines stray
// by half a voxel more, and half a voxel is for rounding.
RADIVOX_CONST float kChangedMargin = 1.5f;

RADIVOX_SHARED_END
#endif
