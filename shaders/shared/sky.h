// The image of a sky: equirectangular, radiance in W/(m² sr), on the whole sphere. v runs from +y (0) to −y (1); u = 0.5 looks along −z and u
// grows towards +x, as from inside; `turn` turns all of it about +y, from −z towards −x.
#ifndef RADIVOX_SHADERS_SHARED_SKY_H
#define RADIVOX_SHADERS_SHARED_SKY_H
#include "functions.h"
#include "voxel.h"
RADIVOX_SHARED_BEGIN

// Rays of pixels see cells, means over 5.6° × 5.6°: about what stands for one ray where a 4×4 block of pixels has some hundreds of them.
RADIVOX_CONST uint kSkyCellColumns = 64u;
RADIVOX_CONST uint kSkyCellRows = 32u;

// scene.sky: vec3 × (kSkyBinCount + kSkyCellColumns · kSkyCellRows + width · height): means over bins, means over cells, texels. Bins and
// cells lack what has become a light of its own (Sky::suns).
RADIVOX_CONST uint kSkyFirstCell = kSkyBinCount;
RADIVOX_CONST uint kSkyFirstTexel = kSkyFirstCell + kSkyCellColumns * kSkyCellRows;

// Where a bin of equal angles along one axis of a cube's side lies: 0 … 3 by tan of −22.5°, 0°, 22.5°.
RADIVOX_FUNCTION uint skyBinStep(float across, float along) {
  RADIVOX_PRECISE float limit = 0.41421356f * along;
  return across < 0.0f ? (across < -limit ? 0u : 1u) : (across < limit ? 2u : 3u);
}

// Bin of a direction: the dominant axis, numbered as voxel faces are; with `fine` one of the kSkyBinSide² of equal angles on that side of a cube.
RADIVOX_FUNCTION uint skyBin(vec3 d, bool fine) {
  vec3 a = abs(d);
  int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  uint side = 2u * uint(axis) + (d[axis] < 0.0f ? 1u : 0u);
  if (!fine) return side;
  uint column = skyBinStep(d[(axis + 1) % 3], a[axis]), row = skyBinStep(d[(axis + 2) % 3], a[axis]);
  return (side * kSkyBinSide + row) * kSkyBinSide + column;
}

RADIVOX_SHARED_END

#ifndef __cplusplus
// (u, v) of a unit direction; u in [0, 1).
vec2 skyPlace(vec3 d, float turn) {
  const float kPi = 3.14159265358979;
  float azimuth = d.x == 0.0 && d.z == 0.0 ? 0.0 : atan(d.x, -d.z);
  return vec2(fract(0.5 + (azimuth + turn) / (2.0 * kPi)), acos(clamp(d.y, -1.0, 1.0)) / kPi);
}
// Index of a cell in scene.sky.
uint skyCell(vec3 d, float turn) {
  uvec2 cell = min(uvec2(skyPlace(d, turn) * vec2(kSkyCellColumns, kSkyCellRows)), uvec2(kSkyCellColumns, kSkyCellRows) - 1u);
  return kSkyFirstCell + cell.y * kSkyCellColumns + cell.x;
}
#endif
#endif
