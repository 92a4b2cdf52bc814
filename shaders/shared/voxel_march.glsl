// From one occupied voxel to the next along a ray. Over shared/traversal.glsl and shared/voxel_lookup.glsl.
//
// Before including, bind GRID, OCCUPANCY, RANK of voxel_lookup.glsl, DISTANCE for kSkipBricks, RADIVOX_BIND_CLEARANCE (shared/clearance.h) for
// kSkipClearance; define RADIVOX_SKIP (a constant of the values below). Call castBegin() first.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_MARCH_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_MARCH_GLSL
#include "shared/clearance.h"
#include "shared/traversal.glsl"
#include "shared/voxel_lookup.glsl"

const uint kSkipNothing = 0u;    // plain steps
const uint kSkipBricks = 1u;     // leap over empty bricks
const uint kSkipClearance = 2u;  // leap out of the empty box around the voxel

// The grid in registers.
uvec3 castSize;
uvec3 castBricks;
bool castDominant;
void castBegin() {
  castSize = grid.size;
  castDominant = grid.dominant != 0u;
  castBricks = grid.bricks;
}

// Every pass of a march moves on by a voxel at least; the bound only guards against coordinates that are not numbers.
uint mostPasses() { return castSize.x + castSize.y + castSize.z + 5u; }

#ifdef RADIVOX_BIND_CLEARANCE
layout(set = 0, binding = RADIVOX_BIND_CLEARANCE) uniform usamplerBuffer clearanceTexels;

// castMarch() by clearance. As traversalLeave() for the box, but in a grid mirrored so that the ray goes up every axis: negation is exact, so times
// keep their bits, and a pass needs no test of which way the ray goes.
bool marchByClearance(TraversalRay ray, inout TraversalCursor cursor, bool live, out uint found) {
  vec3 turn = 2.0 * ray.forward - 1.0;
  vec3 back = 1.0 - ray.forward;
  vec3 voxel = cursor.voxel * turn - back;
  vec3 origin = ray.origin * turn;
  vec3 inverse = abs(ray.inverse);
  vec3 direction = abs(ray.direction);
  float time = cursor.time;
  // clearanceIndex() of the mirrored voxel: what it adds up to along x and y is exact in floats.
  float row = float(castSize.x + 1u);
  vec2 across = vec2(1.0, row) * turn.xy;
  float base = dot(vec2(1.0, row), ray.forward.xy);
  int slice = int((castSize.x + 1u) * (castSize.y + 1u));
  int up = ray.forward.z > 0.5 ? slice : -slice;
  int ground = ray.forward.z > 0.5 ? slice : 0;
  uvec3 shifts = kClearanceBits * (uvec3(0u, 2u, 4u) + uvec3(back));
  bool moved = false;
  uint clearance;
  for (uint passes = mostPasses(); passes > 0u; --passes) {
    uint i = uint(int(voxel.x * across.x + voxel.y * across.y + base) + int(voxel.z) * up + ground);
    clearance = texelFetch(clearanceTexels, int(i)).x;
    if (!live || (clearance & kClearanceOpen) == 0u) break;
    moved = true;
    precise vec3 plane = voxel + 1.0 + vec3((uvec3(clearance) >> shifts) & kMostClearance);
    precise vec3 times = (plane - origin) * inverse;
    bool x = times.x <= times.y && times.x <= times.z;
    bool y = !x && times.y <= times.z;
    bool z = !(x || y);
    float exit = x ? times.x : (y ? times.y : times.z);  // cheaper than min(), which asks what is no number
    precise vec3 guess = floor(origin + exit * direction - 0.5 / 256.0);
    guess = mix(guess, voxel, lessThan(guess, voxel));
    precise vec3 next = (guess + 1.0 - origin) * inverse;
    bvec3 crossed = lessThan(next, vec3(exit));
    crossed.x = crossed.x || (next.x == exit && !x);
    crossed.y = crossed.y || (next.y == exit && z);
    guess += vec3(crossed);
    voxel = mix(guess, plane, bvec3(x, y, z));
    time = exit;
  }
  cursor.voxel = (voxel + back) * turn;
  cursor.time = time;
  found = (clearance & kClearanceOpen) == 0u ? clearance - 1u : kNone;
  return moved;
}
#endif

// Also true of what is no number.
bool isOutside(vec3 voxel) { return !(all(greaterThanEqual(voxel, vec3(0.0))) && all(lessThan(voxel, vec3(castSize)))); }

uint castBrickDistance(uint brick) {
#ifdef RADIVOX_BIND_DISTANCE
  return brickDistance(brick);
#else
  return 0u;
#endif
}

// The empty box around the cursor's voxel; false: none, since the voxel may have faces or is outside.
bool castEmptyBox(TraversalCursor cursor, out vec3 low, out vec3 high) {
  uvec3 voxel = uvec3(clamp(cursor.voxel, vec3(0.0), vec3(castSize - 1u)));
  uint brick = brickOf(voxel, castBricks);
  uint distance = RADIVOX_SKIP == kSkipBricks ? castBrickDistance(brick) : 0u;
  vec3 corner = vec3(voxel & ~3u);
  low = distance > 0u ? corner + 4.0 - 4.0 * float(distance) : cursor.voxel;
  high = distance > 0u ? corner + 4.0 * float(distance) : cursor.voxel + 1.0;
  return !isOutside(cursor.voxel) && (distance > 0u || !hasBit(brickBits(brick), bitOf(voxel)));
}

// Moves on, if `live`, until the cursor is in a voxel that may have faces, or outside. Returns whether it moved. `voxel`: where the cursor is then, kNone:
// outside (or, unless it is `live`, in a voxel without faces).
bool castMarch(TraversalRay ray, inout TraversalCursor cursor, bool live, out uint voxel) {
#ifdef RADIVOX_BIND_CLEARANCE
  if (RADIVOX_SKIP == kSkipClearance) return marchByClearance(ray, cursor, live, voxel);
#endif
  bool moved = false;
  for (uint passes = live ? mostPasses() : 0u; passes > 0u; --passes) {
    vec3 low, high;
    if (!castEmptyBox(cursor, low, high)) break;
    traversalLeave(ray, low, high, cursor);
    moved = true;
  }
  voxel = isOutside(cursor.voxel) ? kNone : voxelIndex(ivec3(cursor.voxel));
  return moved;
}

#endif
