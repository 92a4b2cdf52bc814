// Rays against the triangles in a voxel: exact, where planes of the mean surface are too coarse. Over shared/traversal.glsl. The includer
// declares grid, vertices[], indices[], triangleMaterials[], materials[], textures[] (for alpha masks), triangleFirst[] and triangleIds[]
// (clustered_voxel.triangles), kMasked, `uniform sampler2D triangleCorners` (shared/triangle_corners.h), kCorners: it is there, and the extensions of
// shared/texture.glsl.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_TRIANGLES_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_TRIANGLES_GLSL
#extension GL_KHR_shader_subgroup_vote : require
#include "shared/listed_triangle.h"
#include "shared/texture.glsl"
#include "shared/traversal.glsl"
#include "shared/triangle_corners.h"
#include "shared/triangle_normal.glsl"

const float kNearSlack = 1e-3;       // voxels: hits this far outside a voxel still count for it
const float kEdgeSlack = 1e-5;       // closes the seams between triangles

// Is the triangle there at these weights? (alpha mask)
bool isCovered(uint id, vec2 weights) {
  if (!kMasked) return true;
  Material material = materials[triangleMaterials[id]];
  if ((material.flags & kMaterialAlphaMask) == 0u) return true;
  float alpha = material.alpha;
  if (material.baseTexture != kNoTexture) {
    vec2 a = vertices[indices[3u * id]].uvBase;
    vec2 b = vertices[indices[3u * id + 1u]].uvBase;
    vec2 c = vertices[indices[3u * id + 2u]].uvBase;
    alpha *= sampleTextureLevel(textures[material.baseTexture], a + (b - a) * weights.x + (c - a) * weights.y, 0u).a;
  }
  return alpha >= material.alphaCutoff;
}

// Corners in grid space.
void loadCorners(uint id, out vec3 a, out vec3 b, out vec3 c) {
  if (kCorners) {
    ivec2 at = cornerTexel(id);
    a = texelFetch(triangleCorners, at, 0).xyz;
    b = texelFetch(triangleCorners, at + ivec2(1, 0), 0).xyz;
    c = texelFetch(triangleCorners, at + ivec2(2, 0), 0).xyz;
  } else {
    a = toGridSpace(grid, vertices[indices[3u * id]].position);
    b = toGridSpace(grid, vertices[indices[3u * id + 1u]].position);
    c = toGridSpace(grid, vertices[indices[3u * id + 2u]].position);
  }
}

// Does the ray meet the triangle at least < t < most (voxels)? Only what is the same on every device: no fused operations, a reciprocal of our own.
bool meetsTriangle(TraversalRay ray, uint id, float least, float most, out float time, out vec3 normal) {
  vec3 p0, p1, p2;
  loadCorners(id, p0, p1, p2);
  vec3 a = p0 - ray.origin;
  vec3 e1 = p1 - ray.origin - a;
  vec3 e2 = p2 - ray.origin - a;
  precise vec3 q = vec3(ray.direction.y * e2.z - ray.direction.z * e2.y, ray.direction.z * e2.x - ray.direction.x * e2.z,
                        ray.direction.x * e2.y - ray.direction.y * e2.x);
  precise float determinant = triangleDot(e1, q);
  precise float inverse = (determinant < 0.0 ? -1.0 : 1.0) * preciseReciprocal(max(abs(determinant), 1e-30));
  precise vec3 r = vec3(a.z * e1.y - a.y * e1.z, a.x * e1.z - a.z * e1.x, a.y * e1.x - a.x * e1.y);
  precise float b1 = -triangleDot(a, q) * inverse;
  precise float b2 = triangleDot(ray.direction, r) * inverse;
  precise float t = triangleDot(e2, r) * inverse;
  precise vec3 across = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
  time = t;
  normal = across;
  bool hit = determinant != 0.0 && b1 >= -kEdgeSlack && b2 >= -kEdgeSlack && b1 + b2 <= 1.0 + kEdgeSlack && t > least && t < most;
  return hit && isCovered(id, vec2(b1, b2));
}

// The nearest triangle that the ray meets in the cursor's voxel; `own` never counts. `normal` is not of unit length and looks at the ray.
// Returns whether there is one. Lanes stay together; those without `live` test nothing.
//
// `lift`: how far the ray's origin was lifted off its own surface. In a corner it may lie behind the other wall all the same, by rounding: triangles
// up to half of that behind it still stop the ray. `apart`: listedApart of the entry.
bool nearestTriangle(TraversalRay ray, TraversalCursor cursor, bool live, uint voxel, uint own, float lift, out float time, out vec3 normal,
                     out uint triangle, out uint apart) {
  vec3 exits = traversalExits(ray, cursor.voxel);
  time = min(exits.x, min(exits.y, exits.z)) + kNearSlack;
  float least = max(cursor.time - kNearSlack, -0.5 * lift);
  bool found = false;
  normal = vec3(0.0);
  triangle = 0u;
  apart = 0u;
  uint at = triangleFirst[live ? voxel : 0u];
  uint end = live ? triangleFirst[voxel + 1u] : at;
  for (; subgroupAny(at < end); ++at) {
    bool test = at < end;
    uint entry = test ? triangleIds[at] : 0u;
    uint id = listedTriangle(entry);
    float t;
    vec3 n;
    if (meetsTriangle(ray, id, least, time, t, n) && test && id != own) {
      time = t;
      found = true;
      triangle = id;
      apart = listedApart(entry);
      normal = triangleDot(n, ray.direction) > 0.0 ? -n : n;
    }
  }
  return found;
}

#endif
