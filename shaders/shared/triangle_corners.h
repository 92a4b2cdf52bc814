// The triangles' corners as words (clustered_voxel.triangles): two a corner, its place in grid space in steps of 2⁻²¹ of the least power of two that
// is no less than the grid's longest side: x | y << 21 | z << 42, 21 bits each. Corners that are one stay one, so no seam opens; whole numbers of
// voxels are exact. Rays fetch them in one go where vertices take three loads through three indices.
#ifndef RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#define RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#include "functions.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kCornerBytes = 24u;  // a triangle
RADIVOX_CONST uint kMostCorner = 0x1fffffu;

// Steps a voxel, and voxels a step: powers of two.
RADIVOX_FUNCTION uint cornerBits(uvec3 gridSize) {
  uint longest = max(max(gridSize.x, gridSize.y), max(gridSize.z, 2u)) - 1u;
  longest |= longest >> 1;
  longest |= longest >> 2;
  longest |= longest >> 4;
  longest |= longest >> 8;
  longest |= longest >> 16;
  return 21u - uint(bitCount(longest));
}
RADIVOX_FUNCTION float cornerSteps(uvec3 gridSize) { return uintBitsToFloat((127u + cornerBits(gridSize)) << 23); }
RADIVOX_FUNCTION float cornerStep(uvec3 gridSize) { return uintBitsToFloat((127u - cornerBits(gridSize)) << 23); }

RADIVOX_FUNCTION uvec2 encodeCorner(vec3 p, float steps) {
  uint x = uint(clamp(floor(p.x * steps + 0.5f), 0.0f, float(kMostCorner)));
  uint y = uint(clamp(floor(p.y * steps + 0.5f), 0.0f, float(kMostCorner)));
  uint z = uint(clamp(floor(p.z * steps + 0.5f), 0.0f, float(kMostCorner)));
  return uvec2(x | y << 21, y >> 11 | z << 10);
}
RADIVOX_FUNCTION vec3 decodeCorner(uvec2 code, float step) {
  return vec3(float(code.x & kMostCorner), float(code.x >> 21 | (code.y & 1023u) << 11), float(code.y >> 10)) * step;
}

RADIVOX_SHARED_END
#endif
