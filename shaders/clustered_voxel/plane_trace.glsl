// Rays that stop at the mean planes of voxel faces. Include after structure.glsl with RADIVOX_BIND_DISTANCE defined too.
#ifndef RADIVOX_CLUSTERED_VOXEL_PLANE_TRACE_GLSL
#define RADIVOX_CLUSTERED_VOXEL_PLANE_TRACE_GLSL
#include "shared/traversal.glsl"

// Planes of neighbouring voxels need not meet exactly; a crossing this far outside the voxel still counts, so that no ray slips between.
const float kPlaneSlack = 0.1;

// The face of a voxel that a ray from p (surface normal n) along d meets between times `enter` and `leave`; kNone: none.
uint planeHit(uint voxel, vec3 coord, vec3 p, vec3 n, vec3 d, float enter, float leave, inout float time) {
  uint mask = faceMasks[voxel];
  uint first = firstFaces[voxel];
  uint hit = kNone;
  float nearest = leave + kPlaneSlack;
  for (uint k = 0; k < 3; ++k) {
    uint f = 2 * k + (d[k] > 0.0 ? 1u : 0u);
    if (((mask >> f) & 1u) == 0u) continue;
    uint s = first + uint(bitCount(mask & ((1u << f) - 1u)));
    Face face = faces[s];
    vec3 m = decodeNormal(face.normal);
    float slope = dot(m, d);
    if (slope >= -1e-4) continue;
    vec3 x = coord + decodePosition(face.position);
    float height = dot(p - x, m);
    // The other side of the receiver's own sheet: p may lie a little below the mean plane of a curved one.
    if (dot(m, n) < -0.3 && abs(height) < 0.75) continue;
    float t = -height / slope;
    if (t < enter - kPlaneSlack || t < 1e-3 || t > nearest) continue;
    nearest = t;
    hit = s;
  }
  if (hit != kNone) time = nearest;
  return hit;
}

// The voxel face that the ray meets first, kNone: it leaves the scene.
uint planeTrace(vec3 p, vec3 n, vec3 d, out float time) {
  time = 0.0;
  TraversalRay ray = makeTraversalRay(p, d);
  TraversalCursor cursor;
  if (!traversalBegin(ray, vec3(grid.size), cursor)) return kNone;
  vec3 size = vec3(grid.size);
  for (uint step = 0; step < 8192u; ++step) {
    if (any(lessThan(cursor.voxel, vec3(0.0))) || any(greaterThanEqual(cursor.voxel, size))) return kNone;
    uvec3 coord = uvec3(cursor.voxel);
    uint brick = brickOf(coord, grid.bricks);
    uint empty = brickDistance(brick);
    if (empty > 0u) {
      // Every brick nearer than `empty` is empty: leave that cube in one step.
      vec3 corner = floor(cursor.voxel * 0.25) * 4.0;
      float reach = 4.0 * float(empty - 1u);
      traversalLeave(ray, corner - reach, corner + 4.0 + reach, cursor);
      continue;
    }
    uvec2 word = occupancy[brick];
    uint bit = bitOf(coord);
    if (hasBit(word, bit)) {
      vec3 exits = traversalExits(ray, cursor.voxel);
      uint voxel = brickRank[brick] + countBitsBelow(word, bit);
      uint hit = planeHit(voxel, cursor.voxel, p, n, ray.direction, cursor.time, min(exits.x, min(exits.y, exits.z)), time);
      if (hit != kNone) return hit;
    }
    traversalStep(ray, cursor);
  }
  return kNone;
}

#endif
