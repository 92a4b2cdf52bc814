// How much of a light a surface point sees, by a ray through the triangles in the voxels: what shadow maps are too coarse for. Over
// shared/voxel_march.glsl and shared/voxel_triangles.glsl, whose declarations the includer makes, and kSides: back faces of single-sided materials cast no
// shadow.
#ifndef RADIVOX_SHADERS_FRAME_SHADOW_RAYS_GLSL
#define RADIVOX_SHADERS_FRAME_SHADOW_RAYS_GLSL
#include "shared/voxel_march.glsl"
#include "shared/voxel_triangles.glsl"

const uint kRayFree = 0u;
const uint kRayBlocked = 1u;
const uint kRayUnknown = 2u;  // it met no triangle, but a voxel with too many of them

const float kRayLift = 1e-3;  // voxels, off the surface that a ray starts from

bool castsShadow(uint id, vec3 direction) {
  if (!kSides) return true;
  if ((materials[triangleMaterials[id]].flags & kMaterialDoubleSided) != 0u) return true;
  return triangleDot(triangleNormal(id), direction) >= 0.0;
}

// What is on the way from p, a place on a surface with unit normal g of triangle `own`, along a unit direction up to a distance (m).
uint castShadowRay(vec3 p, vec3 g, vec3 direction, float distance_, uint own) {
  TraversalRay ray = makeTraversalRay(toGridSpace(grid, p) + kRayLift * g, direction);
  float end = distance_ / grid.h;
  TraversalCursor cursor = TraversalCursor(clamp(floor(ray.origin), vec3(0.0), vec3(castSize) - 1.0), 0.0);
  uint result = kRayFree;
  while (true) {
    uint voxel;
    castMarch(ray, cursor, true, voxel);
    if (voxel == kNone || cursor.time >= end) break;
    vec3 exits = traversalExits(ray, cursor.voxel);
    vec2 most = vec2(min(min(exits.x, min(exits.y, exits.z)) + kNearSlack, end), 1.0);
    float least = max(cursor.time - kNearSlack, -0.5 * kRayLift);
    uint last = triangleFirst(voxel + 1u);
    uint at = triangleFirst(voxel);
    if (at == last) result = kRayUnknown;
    bool met = false;
    for (; at < last && !met; ++at) {
      uint id = listedTriangle(triangleIds(at));
      vec2 time;
      met = meetsTriangle(ray, id, least, most, time) && id != own && castsShadow(id, direction);
    }
    if (met) {
      result = kRayBlocked;
      break;
    }
    traversalStep(ray, cursor);
  }
  return result;
}

// The same of the way from p to q, a place beside it on its plane.
uint castBeside(vec3 p, vec3 q, vec3 g, uint own) {
  vec3 way = q - p;
  float distance_ = length(way);
  return distance_ > 0.0 ? castShadowRay(p, g, way / distance_, distance_, own) : kRayFree;
}

#endif
