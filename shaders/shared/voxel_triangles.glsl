// Rays against the triangles in a voxel: exact, where planes of the mean surface are too coarse. Over shared/voxel_march.glsl. The includer
// declares grid, vertices[], indices[], triangleMaterials[], materials[], textures[] (for alpha masks), `uniform usamplerBuffer` triangleFirstTexels and
// triangleIdTexels (clustered_voxel.triangles), kMasked, `uniform isamplerBuffer triangleCorners` (shared/triangle_corners.h), kCorners: it is there, and the extensions of
// shared/texture.glsl.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_TRIANGLES_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_TRIANGLES_GLSL
#include "shared/listed_triangle.h"
#include "shared/texture.glsl"
#include "shared/triangle_corners.h"
#include "shared/triangle_normal.glsl"
#include "shared/voxel_march.glsl"

const float kNearSlack = 1e-3;       // voxels: hits this far outside a voxel still count for it
const float kEdgeSlack = 1e-5;       // closes the seams between triangles

uint triangleFirst(uint voxel) { return texelFetch(triangleFirstTexels, int(voxel)).x; }
uint triangleIds(uint entry) { return texelFetch(triangleIdTexels, int(entry)).x; }

// Is the triangle there at these weights, which are multiplied by `size`? (alpha mask)
bool isCovered(uint id, vec2 multiples, float size) {
  if (!kMasked) return true;
  precise vec2 weights = multiples * preciseReciprocal(max(size, 1e-30));
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

// Corners in grid space, rounded alike wherever they come from. Three fill one and a half texels of four words.
void loadCorners(uint id, out vec3 a, out vec3 b, out vec3 c) {
  float step_ = cornerStep(castSize);
  if (kCorners) {
    int at = int(3u * id) >> 1;
    bool odd = (id & 1u) != 0u;
    uvec4 first = uvec4(texelFetch(triangleCorners, at)), second = uvec4(texelFetch(triangleCorners, at + 1));
    a = decodeCorner(odd ? first.zw : first.xy, step_);
    b = decodeCorner(odd ? second.xy : first.zw, step_);
    c = decodeCorner(odd ? second.zw : second.xy, step_);
  } else {
    float steps = cornerSteps(castSize);
    a = decodeCorner(encodeCorner(toGridSpace(grid, vertices[indices[3u * id]].position), steps), step_);
    b = decodeCorner(encodeCorner(toGridSpace(grid, vertices[indices[3u * id + 1u]].position), steps), step_);
    c = decodeCorner(encodeCorner(toGridSpace(grid, vertices[indices[3u * id + 2u]].position), steps), step_);
  }
}

// triangleNormal() of the rounded corners: many lanes load these at once.
vec3 cornerNormal(uint id) {
  vec3 a, b, c;
  loadCorners(id, a, b, c);
  return normalOfEdges(b - a, c - a);
}

// Does the ray meet the triangle at least < t < most (voxels)? `most` and `time` are fractions: a numerator, and a denominator above 0, so that no
// triangle costs a division. Only what is the same on every device: no fused operations.
bool meetsTriangle(TraversalRay ray, uint id, float least, vec2 most, out vec2 time) {
  vec3 p0, p1, p2;
  loadCorners(id, p0, p1, p2);
  vec3 a = p0 - ray.origin;
  vec3 e1 = p1 - ray.origin - a;
  vec3 e2 = p2 - ray.origin - a;
  precise vec3 q = vec3(ray.direction.y * e2.z - ray.direction.z * e2.y, ray.direction.z * e2.x - ray.direction.x * e2.z,
                        ray.direction.x * e2.y - ray.direction.y * e2.x);
  precise float determinant = triangleDot(e1, q);
  float size = abs(determinant);
  float side = determinant < 0.0 ? -1.0 : 1.0;
  precise vec3 r = vec3(a.z * e1.y - a.y * e1.z, a.x * e1.z - a.z * e1.x, a.y * e1.x - a.x * e1.y);
  precise float b1 = -triangleDot(a, q) * side;
  precise float b2 = triangleDot(ray.direction, r) * side;
  precise float t = triangleDot(e2, r) * side;
  time = vec2(t, size);
  precise float slack = kEdgeSlack * size;
  precise float both = b1 + b2;
  precise float sum = size + slack;
  precise float early = least * size;
  precise float left = t * most.y;
  precise float right = most.x * size;
  bool hit = size > 0.0 && b1 >= -slack && b2 >= -slack && both <= sum && t > early && left < right;
  return hit && isCovered(id, vec2(b1, b2), size);
}

// The nearest of the triangles [at, end) of the cursor's voxel that the ray meets there; `own` never counts. Returns whether there is one; `listed`: its
// entry of the list.
//
// `lift`: how far the ray's origin was lifted off its own surface. In a corner it may lie behind the other wall all the same, by rounding: triangles
// up to half of that behind it still stop the ray.
bool nearestTriangle(TraversalRay ray, TraversalCursor cursor, uint at, uint end, uint own, float lift, out vec2 time, out uint listed) {
  vec3 exits = traversalExits(ray, cursor.voxel);
  time = vec2(min(exits.x, min(exits.y, exits.z)) + kNearSlack, 1.0);
  float least = max(cursor.time - kNearSlack, -0.5 * lift);
  bool found = false;
  listed = 0u;
  for (; at < end; ++at) {
    uint entry = triangleIds(at);
    uint id = listedTriangle(entry);
    vec2 t;
    if (meetsTriangle(ray, id, least, time, t) && id != own) {
      time = t;
      found = true;
      listed = entry;
    }
  }
  return found;
}

#endif
