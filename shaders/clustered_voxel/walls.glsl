// Whether a voxel face stands between two points of neighbouring voxels: interpolation and filtering must not look through walls.
#ifndef RADIVOX_CLUSTERED_VOXEL_WALLS_GLSL
#define RADIVOX_CLUSTERED_VOXEL_WALLS_GLSL

// A face of `voxel` (at `coord`) of direction f whose plane crosses the axis between a and b (grid space, along axis f >> 1).
bool wallAt(ivec3 coord, uint voxel, uint f, float a, float b) {
  uint s = faceIndex(voxel, f);
  if (s == kNone) return false;
  Face face = faces[s];
  uint k = f >> 1;
  // A sill or a slab's edge is no wall: it must cover a good part of the voxel and look along the axis.
  if (face.area < 0.3 || abs(decodeNormal(face.normal)[k]) < 0.8) return false;
  float plane = float(coord[k]) + decodePosition(face.position)[k];
  return (plane - a) * (plane - b) < 0.0 && min(abs(plane - a), abs(plane - b)) > 0.02;
}

// Walls that look back at `from` in either end's voxel, along each axis in which the two points differ by more than the surface's own slope.
bool wallBetween(ivec3 fromCoord, uint fromVoxel, vec3 from, ivec3 toCoord, uint toVoxel, vec3 to) {
  for (uint k = 0; k < 3; ++k) {
    float step = to[k] - from[k];
    if (abs(step) < 0.05) continue;
    uint f = 2 * k + (step > 0.0 ? 1u : 0u);
    if (fromVoxel != kNone && wallAt(fromCoord, fromVoxel, f, from[k], to[k])) return true;
    if (wallAt(toCoord, toVoxel, f, from[k], to[k])) return true;
  }
  return false;
}

#endif
