// Which of the three voxel faces that surface looks towards it belongs to. C++ and GLSL compile the same text.
#ifndef RADIVOX_SHADERS_SHARED_FACE_SHARES_H
#define RADIVOX_SHADERS_SHARED_FACE_SHARES_H
#include "functions.h"
RADIVOX_SHARED_BEGIN

// Lengths that differ by less are equal, and then the first axis counts: surface at 45° goes one way, however its normal was rounded.
RADIVOX_CONST float kSameShare = 1.0001f;

// Of the area of surface with unit normal n, how much each axis' face gets: |n·e| or, where Grid::dominant, all or nothing.
RADIVOX_FUNCTION vec3 faceShares(vec3 n, bool dominant) {
  vec3 size = abs(n);
  bool x = size.x * kSameShare >= size.y && size.x * kSameShare >= size.z;
  bool y = !x && size.y * kSameShare >= size.z;
  return dominant ? vec3(x ? 1.0f : 0.0f, y ? 1.0f : 0.0f, x || y ? 0.0f : 1.0f) : size;
}

RADIVOX_SHARED_END
#endif
