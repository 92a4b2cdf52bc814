// What a ray sees in the voxel grid: the first voxel face that it crosses. Over shared/traversal.glsl and shared/voxel_lookup.glsl;
// tests/oracles/traversal_oracle.h says the same on the CPU.
//
// Before including, bind GRID, OCCUPANCY, RANK, FACE_MASK, FIRST_FACE, FACES of voxel_lookup.glsl, DISTANCE for kSkipBricks,
// RADIVOX_BIND_CLEARANCE for kSkipClearance, and define RADIVOX_SKIP and RADIVOX_HIT (constants of the values below).
//
// Which face is hit (kHitPlane). A face stands for surface in its voxel: an area a_f about the mean point x_f with mean normal n_f.
// Taking every occupied voxel for a wall stops rays on the next step of the very surface they leave; lifting origins off the
// surface puts some into the next room. So a ray hits face f when, inside the voxel,
//   (1) it looks at the face: d·e_f < 0 and d·n_f < 0;
//   (2) it passes from the front of the plane (x_f, n_f) to its back, or was in front of the face f of the voxel before and is behind
//       this one's (surfaces that bend pass between two planes otherwise);
//   (3) it does so within the part of the voxel that the surface can cover: |p − x_f| ≤ min(x_f, 1 − x_f) + 0.05 along both axes of
//       the face, unless a_f says that the surface fills the voxel.
// Of several, one is drawn with probability ∝ a_f (−d·e_f). In the voxel of the origin, faces on the origin's own plane do not count.
// kHitVoxel is the paper's: any voxel with a face that looks at the ray stops it.
//
// Measured against exact rays on Sponza (N = 128, all faces, weight a_s): RMSE of the missed share 0.013 (kHitVoxel lifted
// by 1.5 h: 0.018 to 0.053, not lifted: 0.23), mean error of E 36 % (50 %, 270 %); leaks of a closed room below 2e-4 of the rays.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_CAST_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_CAST_GLSL
#include "shared/clearance.h"
#include "shared/traversal.glsl"
#include "shared/voxel_lookup.glsl"

const uint kSkipNothing = 0u;    // plain steps
const uint kSkipBricks = 1u;     // brickDistances[]: leap over empty bricks
const uint kSkipClearance = 2u;  // clearance[]: leap out of the empty cube around the voxel
const uint kHitPlane = 0u;
const uint kHitVoxel = 1u;

const float kOwnPlaneDistance = 0.25;  // voxels
const float kOwnPlaneCosine = 0.82;    // 35°
const float kCoverSlack = 0.05;        // voxels
const float kCoverFull = 0.95;         // a_f from which a face fills its voxel
const float kInFront = -1e-3;          // voxels behind a plane that still count as in front of it, for the next voxel

const uint kHitNothing = kNone;           // face: the ray left the grid
const uint kHitBack = kNone - 1u;         // face: stopped by the back of a one-sided surface

#ifdef RADIVOX_BIND_CLEARANCE
layout(set = 0, binding = RADIVOX_BIND_CLEARANCE, scalar) readonly buffer RadivoxClearance { uint clearance[]; };
float clearanceAt(vec3 voxel) {
  uint i = clearanceIndex(uvec3(ivec3(voxel) + 1), grid.size);
  uint word = clearance[i >> 2];
  // Two constant shifts instead of one that differs per lane.
  word = (i & 1u) != 0u ? word >> 8 : word;
  word = (i & 2u) != 0u ? word >> 16 : word;
  return float(word & 0xffu);
}
#endif

// Also true of what is no number.
bool isOutside(vec3 voxel) { return !(all(greaterThanEqual(voxel, vec3(0.0))) && all(lessThan(voxel, vec3(grid.size)))); }

uint castBrickDistance(uint brick) {
#ifdef RADIVOX_BIND_DISTANCE
  return brickDistance(brick);
#else
  return 0u;
#endif
}

// Moves on until the cursor is in a voxel that may have faces, or outside; not at all if it is already. Returns whether it moved.
bool castMarch(TraversalRay ray, inout TraversalCursor cursor) {
  // Every pass moves on by a voxel at least; the bound only guards against coordinates that are not numbers.
  uint all_ = grid.size.x + grid.size.y + grid.size.z + 4u;
  uint passes = all_;
  if (RADIVOX_SKIP == kSkipClearance) {
#ifdef RADIVOX_BIND_CLEARANCE
    for (float c = clearanceAt(cursor.voxel); c > 0.0 && passes > 0u; --passes) {
      traversalLeave(ray, cursor.voxel + 1.0 - c, cursor.voxel + c, cursor);
      c = clearanceAt(cursor.voxel);
    }
#endif
  } else {
    for (; passes > 0u && !isOutside(cursor.voxel); --passes) {
      uvec3 voxel = uvec3(cursor.voxel);
      vec3 low = cursor.voxel;
      vec3 high = cursor.voxel + 1.0;
      uint brick = brickOf(voxel, grid.bricks);
      uint distance = RADIVOX_SKIP == kSkipBricks ? castBrickDistance(brick) : 0u;
      if (distance == 0u) {
        if (hasBit(occupancy[brick], bitOf(voxel))) break;
      } else {
        low = vec3(4 * (ivec3(voxel >> 2) - int(distance) + 1));
        high = vec3(4 * (ivec3(voxel >> 2) + int(distance)));
      }
      traversalLeave(ray, low, high, cursor);
    }
  }
  return passes != all_;
}

float castDot(vec3 a, vec3 b) {
  precise float sum = a.x * b.x + a.y * b.y;
  precise float all_ = sum + a.z * b.z;
  return all_;
}

// The direction of a packed normal, |x| + |y| + |z| = 1: signs and ratios of distances to a plane need no unit normal.
vec3 castNormal(uint code) {
  precise float x = float(int(code << 16) >> 16) * (1.0 / 32767.0);
  precise float y = float(int(code) >> 16) * (1.0 / 32767.0);
  precise float z = 1.0 - abs(x) - abs(y);
  float fold = max(-z, 0.0);
  precise float foldedX = x + (x >= 0.0 ? -fold : fold);
  precise float foldedY = y + (y >= 0.0 ? -fold : fold);
  return vec3(foldedX, foldedY, z);
}

// The faces of `voxel` on the plane of a point: they do not count in the point's own voxel.
uint ownFaces(uint voxel, uvec3 coordinate, vec3 position, vec3 normal) {
  uint mask = faceMasks[voxel];
  uint own = 0u;
  for (uint f = 0u, s = firstFaces[voxel]; f < kFaceCount; ++f) {
    if (((mask >> f) & 1u) == 0u) continue;
    Face face = faces[s++];
    precise float offset = abs(castDot(facePosition(face, coordinate) - position, normal));
    precise float cosine = abs(castDot(decodeNormal(face.normal), normal));
    if (offset < kOwnPlaneDistance && cosine > kOwnPlaneCosine) own |= 1u << f;
  }
  return own;
}

// (3) above: does the ray, passing `before` in front of the plane and `behind` at its back, meet the face where it has surface?
bool castCovers(Face face, vec3 mean, vec3 center, vec3 enterPoint, vec3 leavePoint, float before, float behind, uint axis) {
  precise vec3 reach = min(mean, 1.0 - mean);
  vec3 across = vec3(axis != 0u, axis != 1u, axis != 2u);
  precise vec3 sides = mix(vec3(1.0), 2.0 * reach, greaterThan(across, vec3(0.5)));
  precise float cover = sides.x * sides.y * sides.z;
  // A mean of several surfaces says nothing about where they end.
  if (face.area > kCoverFull || cover < 0.98 * face.area) return true;
  // Both sides times before + behind: no division.
  precise float whole = before + behind;
  precise vec3 offset = (enterPoint - center) * whole + (leavePoint - enterPoint) * before;
  precise vec3 limit = (reach + kCoverSlack) * whole;
  return all(lessThanEqual(abs(offset) * across, limit));
}

// The face of the cursor's voxel that the ray hits before it leaves the voxel; kHitNothing: none, the ray goes on; kHitBack. Faces in
// `excluded` do not count. `inFront` carries rule (2) from voxel to voxel: 0 where the voxel before had no faces. `random` is uniform.
uint castFace(TraversalRay ray, TraversalCursor cursor, uint excluded, inout uint inFront, uint random) {
  uint wasInFront = inFront;
  inFront = 0u;
  uint voxel = voxelIndex(ivec3(cursor.voxel));
  if (voxel == kNone) return kHitNothing;
  uint mask = faceMasks[voxel];
  uint first = firstFaces[voxel];
  vec3 exits = traversalExits(ray, cursor.voxel);
  float exit = min(exits.x, min(exits.y, exits.z));
  precise vec3 enterPoint = ray.origin + cursor.time * ray.direction;
  precise vec3 leavePoint = ray.origin + exit * ray.direction;
  vec3 weight = vec3(0.0);
  uvec3 found = uvec3(0u);
  bool back = false;
  for (uint axis = 0u; axis < 3u; ++axis) {
    float d = ray.direction[axis];
    uint facing = 2u * axis + (d > 0.0 ? 1u : 0u);
    bool isFront = ((mask >> facing) & 1u) != 0u;
    // One-sided surface seen from behind: its face looks the other way.
    uint f = isFront ? facing : facing ^ 1u;
    if (d == 0.0 || ((mask & ~excluded) >> f & 1u) == 0u) continue;
    uint s = first + uint(bitCount(mask & ((1u << f) - 1u)));
    Face face = faces[s];
    bool hits = true;
    if (RADIVOX_HIT == kHitPlane) {
      vec3 mean = decodePosition(face.position);
      precise vec3 center = cursor.voxel + mean;
      vec3 n = castNormal(face.normal);
      n = isFront ? n : -n;
      float before = castDot(enterPoint - center, n);
      float after = castDot(leavePoint - center, n);
      if (after >= kInFront) inFront |= 1u << facing;
      hits = castDot(ray.direction, n) < 0.0 && after <= 0.0 && (before >= 0.0 || ((wasInFront >> facing) & 1u) != 0u);
      hits = hits && castCovers(face, mean, center, enterPoint, leavePoint, max(before, 0.0), -after, axis);
    }
    precise float w = face.area * abs(d);
    if (hits && isFront) {
      weight[axis] = w;
      found[axis] = s;
    }
    back = back || (hits && !isFront);
  }
  precise float two = weight.x + weight.y;
  precise float total = two + weight.z;
  if (!(total > 0.0)) return back ? kHitBack : kHitNothing;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  if (draw < weight.x) return found.x;
  if (draw >= two && weight.z > 0.0) return found.z;
  return weight.y > 0.0 ? found.y : found.x;
}

#endif
