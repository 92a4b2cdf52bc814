// The planes of a voxel's surface: what rays are stopped by (shared/voxel_cast.glsl). Made by clustered_voxel.visibility.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_PLANE_H
#define RADIVOX_SHADERS_SHARED_VOXEL_PLANE_H
#include "voxel_codec.h"
RADIVOX_SHARED_BEGIN

// Faces of a voxel whose mean planes agree share one, that of the largest face (the lowest of equals): four of five voxels have a
// single plane. Two words each, so that a voxel's fits beside its neighbours' in a cache line: the plane of the voxel's largest
// face at its compact index, the others, where kPlaneMore says so, from V + planeExtras[voxel] on.
//   word 0: normal n, octahedral snorm10 × 2 | faces on the plane that show fronts << 20 | faces of the voxel << 26 (0: no planes)
//   word 1: n·x in steps of kPlaneStep, 13 bits signed | faceMargins of the largest face << 13 | its axis << 29 | kPlaneMore
RADIVOX_CONST uint kPlaneMore = 0x80000000u;     // another plane follows
RADIVOX_CONST float kPlaneStep = 1.0f / 4095.0f;  // |n·x| ≤ 1, since |n.x| + |n.y| + |n.z| = 1 and x lies in the unit cube
RADIVOX_CONST float kSamePlaneCosine = 0.99f;    // 8°
RADIVOX_CONST float kSamePlaneDistance = 0.05f;  // voxels

// The octahedral coordinates of Face::normal in 10 bits each: within 0.2°.
RADIVOX_FUNCTION uint planeNormalCode(uint faceNormal) {
  RADIVOX_PRECISE float x = floor(float(int(faceNormal << 16) >> 16) * (511.0f / 32767.0f) + 0.5f);
  RADIVOX_PRECISE float y = floor(float(int(faceNormal) >> 16) * (511.0f / 32767.0f) + 0.5f);
  return (uint(int(x)) & 1023u) | (uint(int(y)) & 1023u) << 10;
}
// A normal with |x| + |y| + |z| = 1: signs and ratios of distances to a plane need no unit vector.
RADIVOX_FUNCTION vec3 planeNormal(uint word0) {
  RADIVOX_PRECISE float x = float(int(word0 << 22) >> 22) * (1.0f / 511.0f);
  RADIVOX_PRECISE float y = float(int(word0 << 12) >> 22) * (1.0f / 511.0f);
  RADIVOX_PRECISE float z = 1.0f - abs(x) - abs(y);
  float fold = max(-z, 0.0f);
  RADIVOX_PRECISE float foldedX = x + (x >= 0.0f ? -fold : fold);
  RADIVOX_PRECISE float foldedY = y + (y >= 0.0f ? -fold : fold);
  return vec3(foldedX, foldedY, z);
}
RADIVOX_FUNCTION uint encodePlaneOffset(vec3 n, vec3 x) {
  RADIVOX_PRECISE float two = n.x * x.x + n.y * x.y;
  RADIVOX_PRECISE float offset = two + n.z * x.z;
  RADIVOX_PRECISE float steps = floor(offset * 4095.0f + 0.5f);
  return uint(int(steps)) & 0x1fffu;
}
RADIVOX_FUNCTION float planeOffset(uint word1) { return float(int(word1 << 19) >> 19) * kPlaneStep; }
RADIVOX_FUNCTION uint planeMargins(uint word1) { return (word1 >> 13) & 0xffffu; }
RADIVOX_FUNCTION uint planeAxis(uint word1) { return (word1 >> 29) & 3u; }

RADIVOX_SHARED_END
#endif
