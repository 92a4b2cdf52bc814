// What the overlay's shader and its host side agree on.
#ifndef RADIVOX_SHADERS_VIEWER_OVERLAY_H
#define RADIVOX_SHADERS_VIEWER_OVERLAY_H
#include "../shared/types.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kPaintAlbedo = 0u;          // of the voxel face
RADIVOX_CONST uint kPaintClusters = 1u;        // a colour per cluster
RADIVOX_CONST uint kPaintClusterNormals = 2u;  // n of the face's cluster, as 0.5 + 0.5 n
RADIVOX_CONST uint kPaintValues = 3u;          // values[face] · scale, a colour
RADIVOX_CONST uint kPaintMarks = 4u;           // how much of marks[cluster] or marks[clusterCount + face], over the picture in grey

struct PaintPush {
  uint width;
  uint height;
  uint mode;
  uint clusterCount;
  uint valueStride;   // floats a face: 3 or 4
  uint usesValid;     // 1: faces without their bit in `valid` have no value
  uint pointedFace;   // id + 1 of the face under the mouse; 0: none
  float scale;        // value → display, before encoding
  float markScale;    // mark → [0, 1]
  uint hasPicture;    // 0: voxels alone, no picture under them
};

RADIVOX_SHARED_END
#endif
