#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests: where a ray from anywhere first comes to a voxel that stops the march, with and without leaps.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSkip = 2;

#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_DISTANCE 3
#define RADIVOX_BIND_PLANES 4
#define RADIVOX_BIND_PLANE_EXTRAS 5
#define RADIVOX_BIND_CAST_FIRST 6
#define RADIVOX_BIND_CLEARANCE 7
#define RADIVOX_VOXEL_COUNT 1u
#define RADIVOX_SKIP kSkip
#define RADIVOX_HIT kHitPlane
struct TestRay {
  vec3 origin;
  vec3 direction;
};
struct TestStop {
  ivec3 voxel;  // outside the grid: the ray left it
  float time;
  uint entered;
};
layout(set = 0, binding = 8, scalar) readonly buffer Rays { TestRay rays[]; };
layout(set = 0, binding = 9, scalar) writeonly buffer Stops { TestStop stops[]; };
layout(push_constant, scalar) uniform Push { uint rayCount; };
#include "shared/dispatch.glsl"
#include "shared/voxel_cast.glsl"

void main() {
  castBegin();
  uint i = min(radivoxItemIndex(), rayCount - 1u);
  TraversalRay ray = makeTraversalRay(rays[i].origin, rays[i].direction);
  TraversalCursor cursor;
  bool entered = traversalBegin(ray, vec3(castSize), cursor);
  if (!entered) cursor = TraversalCursor(vec3(-1.0), 0.0);
  uint voxel;
  castMarch(ray, cursor, entered, voxel);
  if (radivoxItemIndex() < rayCount) stops[i] = TestStop(ivec3(cursor.voxel), cursor.time, entered ? 1u : 0u);
}
