// Where in the voxel a piece lies, seen along an axis: which of 16 slabs across each of the other two axes it may pass.
#ifndef RADIVOX_VOXELIZE_FOOTPRINT_GLSL
#define RADIVOX_VOXELIZE_FOOTPRINT_GLSL
#include "clustered_voxel/voxelize/triangle.glsl"

// A piece this much aslant to the axis leaves no footprint: it is a sliver there, and the face of another axis stands for it.
const float kLeastFootprint = 0.25;
// Slabs are this much thinner than a sixteenth of the voxel on both sides, in voxel edges: surface that ends where a slab begins is not in it.
// (The outermost surfaces of a scene lie half-way through their voxels, exactly.)
const float kSlabMargin = 1e-3;

// Slabs across turned axis i, of the voxel seen along k (j is the third): a separating-axis test of the triangle against each slab by its bounds,
// its plane and its edges seen along k. The two other views are left out, so a slab too many may count.
uint slabsAcross(Triangle t, vec3 q[3], uint i, uint j, uint k) {
  const float size = 1.0 / float(kMarginSteps);
  const float radius = 0.5 * size - kSlabMargin;
  float least = min(q[0][i], min(q[1][i], q[2][i]));
  float most = max(q[0][i], max(q[1][i], q[2][i]));
  precise float height = t.normal.x * q[0].x + t.normal.y * q[0].y + t.normal.z * q[0].z;
  precise float reach = radius * abs(t.normal[i]) + 0.5 * (abs(t.normal[j]) + abs(t.normal[k]));
  // Edge × position seen along k, with the sign that makes it positive inside.
  float side[3], slope[3], width[3];
  float sense = t.normal[k] < 0.0 ? -1.0 : 1.0;
  for (uint e = 0u; e < 3u; ++e) {
    precise float at = t.edge[e][j] * q[e][i] - t.edge[e][i] * q[e][j];
    precise float extent = radius * abs(t.edge[e][j]) + 0.5 * abs(t.edge[e][i]);
    bool isNext = j == (i + 1u) % 3u;  // i, j, k turn round as x, y, z do
    side[e] = at * (isNext ? sense : -sense);
    slope[e] = t.edge[e][j] * (isNext ? -sense : sense);
    width[e] = extent;
  }
  uint slabs = 0u;
  for (uint s = 0u; s < kMarginSteps; ++s) {
    precise float centre = (float(s) + 0.5) * size - 0.5;
    bool passes = least < centre + radius && most > centre - radius && abs(height - t.normal[i] * centre) <= reach;
    for (uint e = 0u; e < 3u; ++e) passes = passes && side[e] + slope[e] * centre >= -width[e];
    slabs |= passes ? 1u << s : 0u;
  }
  return slabs;
}

// Slabs across axis k + 1 | slabs across axis k + 2 << 16; of a sliver 0.
uint footprintOf(Triangle t, ivec3 voxel, Piece piece, uint k) {
  if (abs(piece.normal[k]) < kLeastFootprint) return 0u;
  vec3 centre = vec3(voxel) + 0.5;
  precise vec3 q[3] = vec3[3](t.p[0] - centre, t.p[1] - centre, t.p[2] - centre);
  uint i = (k + 1u) % 3u, j = (k + 2u) % 3u;
  return slabsAcross(t, q, i, j, k) | slabsAcross(t, q, j, i, k) << 16;
}

#endif
