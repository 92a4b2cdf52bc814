// The planes of a voxel's surface: what rays are stopped by (shared/voxel_cast.glsl). Made by clustered_voxel.visibility.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_PLANE_H
#define RADIVOX_SHADERS_SHARED_VOXEL_PLANE_H
#include "voxel_codec.h"
RADIVOX_SHARED_BEGIN

// Faces of a voxel whose mean planes agree share one, that of the largest face (the lowest of equals): four of five voxels have a
// single plane. Two words each, so that a voxel's fits beside its neighbours' in a cache line: the plane of the voxel's largest
// face at its compact index, the others, where kPlaneMore says so, from V + planeExtras[voxel] on.
//   word 0: normal, octahedral snorm10 × 2 | faces on the plane << 20 | faces of the voxel << 26 (0: no planes)
//   word 1: point x inside the voxel, unorm 10:10:10 | kPlaneBounded | kPlaneMore
RADIVOX_CONST uint kPlaneBounded = 0x40000000u;  // the surface ends within its reach about x, see voxel_cast.glsl
RADIVOX_CONST uint kPlaneMore = 0x80000000u;     // another plane follows
RADIVOX_CONST float kSamePlaneCosine = 0.99f;    // 8°
RADIVOX_CONST float kSamePlaneDistance = 0.05f;  // voxels
RADIVOX_CONST float kCoverFull = 0.95f;          // a_f from which a face fills its voxel

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
// The axis that a plane lies across: the largest of |n|, the lowest of equals.
RADIVOX_FUNCTION uint planeAxis(vec3 n) {
  vec3 a = abs(n);
  return a.x >= a.y && a.x >= a.z ? 0u : (a.y >= a.z ? 1u : 2u);
}

RADIVOX_SHARED_END
#endif
