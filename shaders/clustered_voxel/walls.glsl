// Whether a voxel face stands between two points of neighbouring voxels: interpolation and filtering must not look through walls.
#ifndef RADIVOX_CLUSTERED_VOXEL_WALLS_GLSL
#define RADIVOX_CLUSTERED_VOXEL_WALLS_GLSL
#define RADIVOX_WALL_STEP 0.05   // voxels: along an axis in which two points differ by less, no wall stands between them
#ifndef RADIVOX_WALL_SLACK
#define RADIVOX_WALL_SLACK 0.02  // voxels: a wall nearer than this to one of the points is the surface that it lies on
#define RADIVOX_WALL_AREA 0.3    // h²: a sill or a slab's edge is no wall
#define RADIVOX_WALL_COSINE 0.8  // between a wall's normal and the axis
#endif

// A face of `voxel` (at `coord`) of direction f whose plane crosses the axis between a and b (grid space, along axis f >> 1). Where a wall
// meets the surface that is lit, the voxel may hold a scrap of it only: the next voxel in front of the surface, `ahead`, tells.
bool wallAt(ivec3 coord, uint voxel, uint f, float a, float b, ivec3 ahead) {
  uint s = faceIndex(voxel, f);
  if (s == kNone) return false;
  uint k = f >> 1;
  if (faceAt(s).area < RADIVOX_WALL_AREA && ahead[k] == 0) {
    coord += ahead;
    voxel = voxelIndex(coord);
    s = voxel == kNone ? kNone : faceIndex(voxel, f);
    if (s == kNone) return false;
  }
  Face face = faceAt(s);
  if (face.area < RADIVOX_WALL_AREA || abs(decodeNormal(face.normal)[k]) < RADIVOX_WALL_COSINE) return false;
  precise float plane = float(coord[k]) + decodePosition(face.position)[k];
  precise float fromPlane = a - plane;
  precise float toPlane = b - plane;
  return fromPlane * toPlane <= 0.0 && min(abs(fromPlane), abs(toPlane)) >= RADIVOX_WALL_SLACK;
}

// One step along the normal's main axis.
ivec3 stepAhead(vec3 n) {
  vec3 size = abs(n);
  uint k = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
  ivec3 ahead = ivec3(0);
  ahead[k] = n[k] < 0.0 ? -1 : 1;
  return ahead;
}

// Walls that look back at `from` in either end's voxel, along each axis in which the two points differ by more than the surface's own slope.
bool wallBetween(ivec3 fromCoord, uint fromVoxel, vec3 from, ivec3 toCoord, uint toVoxel, vec3 to, ivec3 ahead) {
  for (uint k = 0; k < 3; ++k) {
    float step = to[k] - from[k];
    if (abs(step) < RADIVOX_WALL_STEP) continue;
    uint f = 2 * k + (step > 0.0 ? 1u : 0u);
    if (fromVoxel != kNone && wallAt(fromCoord, fromVoxel, f, from[k], to[k], ahead)) return true;
    if (wallAt(toCoord, toVoxel, f, from[k], to[k], ahead)) return true;
  }
  return false;
}

#endif
