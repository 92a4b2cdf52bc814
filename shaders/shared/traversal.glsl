// Walking a voxel grid along a ray: every voxel the ray touches, in order, with exact rules for ties, so that leaping over empty space
// gives the same voxels and the same times as single steps, bit for bit (and as tests/oracles/traversal_oracle.h, which only steps).
//
// A voxel is left through plane p of axis k at time t_k(p) = (p − o_k) · (1 / d_k), always from the integer plane and never by adding
// up, so no rounding gathers. The next crossing is the smallest (t, k): at equal times the lowest axis first. 1 / d is
// preciseReciprocal; components below kTraversalFlat count as 0 and are never crossed.
//
// Valid for origins within 2048 voxels of the grid, grids up to 1024 voxels a side.
#ifndef RADIVOX_SHADERS_SHARED_TRAVERSAL_GLSL
#define RADIVOX_SHADERS_SHARED_TRAVERSAL_GLSL
#include "shared/functions.h"

const float kTraversalFlat = 1e-6;
const float kTraversalNever = 1e30;  // 1 / d of a flat component: its planes are crossed after everything else

struct TraversalRay {
  vec3 origin;     // grid space
  vec3 direction;  // unit, within rounding
  vec3 inverse;
  vec3 forward;    // per axis 1: towards +, 0: towards −
};

float traversalInverse(float d) {
  precise float r = preciseReciprocal(abs(d));
  return d < 0.0 ? -r : r;
}

TraversalRay makeTraversalRay(vec3 origin, vec3 direction) {
  TraversalRay ray;
  bvec3 flat_ = lessThan(abs(direction), vec3(kTraversalFlat));
  ray.origin = origin;
  ray.direction = mix(direction, vec3(0.0), flat_);
  vec3 d = mix(direction, vec3(1.0), flat_);
  vec3 inverse = vec3(traversalInverse(d.x), traversalInverse(d.y), traversalInverse(d.z));
  ray.inverse = mix(inverse, vec3(kTraversalNever), flat_);
  ray.forward = vec3(greaterThanEqual(ray.direction, vec3(0.0)));
  return ray;
}

// Where the ray is: a voxel (whole numbers) and the time of its entry into it.
struct TraversalCursor {
  vec3 voxel;
  float time;
};

// When the ray leaves the voxel, per axis.
vec3 traversalExits(TraversalRay ray, vec3 voxel) {
  precise vec3 plane = voxel + ray.forward;
  precise vec3 times = (plane - ray.origin) * ray.inverse;
  return times;
}

// The axis that is crossed first, as a mask with one 1.
vec3 traversalFirst(vec3 times) {
  bool x = times.x <= times.y && times.x <= times.z;
  bool y = !x && times.y <= times.z;
  return vec3(x, y, !(x || y));
}

// One voxel on.
void traversalStep(TraversalRay ray, inout TraversalCursor cursor) {
  vec3 times = traversalExits(ray, cursor.voxel);
  cursor.voxel += traversalFirst(times) * (2.0 * ray.forward - 1.0);
  cursor.time = min(times.x, min(times.y, times.z));
}

// On to the first voxel outside the box of voxels [low, high), which holds the cursor.
void traversalLeave(TraversalRay ray, vec3 low, vec3 high, inout TraversalCursor cursor) {
  bvec3 forward = greaterThan(ray.forward, vec3(0.5));
  precise vec3 plane = mix(low, high, forward);
  precise vec3 times = (plane - ray.origin) * ray.inverse;
  vec3 first = traversalFirst(times);
  float exit = min(times.x, min(times.y, times.z));
  // Rounding moves a point by less than 1e-3 voxels here; held back by twice that, a guess is right or one voxel short.
  precise vec3 guess = floor(ray.origin + exit * ray.direction - (ray.forward - 0.5) * (1.0 / 256.0));
  guess = mix(min(guess, cursor.voxel), max(guess, cursor.voxel), forward);
  precise vec3 next = (guess + ray.forward - ray.origin) * ray.inverse;
  // Crossed before the exit: earlier, or at the same time on a lower axis.
  bvec3 crossed = lessThan(next, vec3(exit));
  crossed.x = crossed.x || (next.x == exit && first.x == 0.0);
  crossed.y = crossed.y || (next.y == exit && first.z == 1.0);
  guess += vec3(crossed) * (2.0 * ray.forward - 1.0);
  cursor.voxel = mix(guess, plane - (1.0 - ray.forward), greaterThan(first, vec3(0.5)));
  cursor.time = exit;
}

// The voxel of the origin; from outside the grid, the first voxel inside. False: the ray never enters.
bool traversalBegin(TraversalRay ray, vec3 size, out TraversalCursor cursor) {
  cursor.voxel = floor(ray.origin);
  cursor.time = 0.0;
  const float kFar = 4096.0;
  for (int k = 0; k < 3; ++k) {
    // All that lies before the grid along this axis is one empty box.
    if (cursor.voxel[k] >= 0.0 && cursor.voxel[k] < size[k]) continue;
    bool before = cursor.voxel[k] < 0.0;
    if (before != (ray.forward[k] > 0.5) || ray.direction[k] == 0.0) return false;
    vec3 low = vec3(-kFar);
    vec3 high = vec3(kFar);
    if (before) {
      high[k] = 0.0;
    } else {
      low[k] = size[k];
    }
    traversalLeave(ray, low, high, cursor);
  }
  return all(greaterThanEqual(cursor.voxel, vec3(0.0))) && all(lessThan(cursor.voxel, size));
}

#endif
