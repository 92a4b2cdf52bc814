// The first voxels of a ray: exact triangles. Over shared/voxel_cast.glsl; include after it. The includer declares `vertices`, `indices`,
// `triangleMaterials`, `materials`, `textures` (alpha masks only), `triangleFirst` and `triangleIds` (clustered_voxel.triangles), kMasked, and
// the extensions of shared/texture.glsl.
#ifndef RADIVOX_NEAR_TRIANGLES_GLSL
#define RADIVOX_NEAR_TRIANGLES_GLSL
#include "shared/texture.glsl"

const float kNearSlack = 1e-3;       // voxels: hits this far outside a voxel still count for it
const float kEdgeSlack = 1e-5;       // closes the seams between triangles
const uint kListCrowded = 0xffffffffu;

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

// The nearest triangle that the ray meets in the cursor's voxel; `own` never counts. `normal` is not of unit length and looks at the ray.
// Returns whether there is one. Lanes stay together; those without `live` test nothing.
bool meetsTriangle(TraversalRay ray, TraversalCursor cursor, bool live, uint voxel, uint own, out float time, out vec3 normal) {
  vec3 exits = traversalExits(ray, cursor.voxel);
  float nearest = min(exits.x, min(exits.y, exits.z)) + kNearSlack;
  float least = max(cursor.time - kNearSlack, 0.0);
  bool found = false;
  normal = vec3(0.0);
  uint at = triangleFirst[live ? voxel : 0u];
  uint end = live ? triangleFirst[voxel + 1u] : at;
  for (; subgroupAny(at < end); ++at) {
    bool test = at < end;
    uint id = test ? triangleIds[at] : 0u;
    test = test && id != own;
    vec3 a = toGridSpace(grid, vertices[indices[3u * id]].position) - ray.origin;
    vec3 e1 = toGridSpace(grid, vertices[indices[3u * id + 1u]].position) - ray.origin - a;
    vec3 e2 = toGridSpace(grid, vertices[indices[3u * id + 2u]].position) - ray.origin - a;
    // Only what stays the same on every device: no fused operations, a reciprocal of our own.
    precise vec3 q = vec3(ray.direction.y * e2.z - ray.direction.z * e2.y, ray.direction.z * e2.x - ray.direction.x * e2.z,
                          ray.direction.x * e2.y - ray.direction.y * e2.x);
    precise float determinant = castDot(e1, q);
    precise float inverse = (determinant < 0.0 ? -1.0 : 1.0) * preciseReciprocal(max(abs(determinant), 1e-30));
    precise vec3 r = vec3(a.z * e1.y - a.y * e1.z, a.x * e1.z - a.z * e1.x, a.y * e1.x - a.x * e1.y);
    precise float b1 = -castDot(a, q) * inverse;
    precise float b2 = castDot(ray.direction, r) * inverse;
    precise float t = castDot(e2, r) * inverse;
    bool hit = test && determinant != 0.0 && b1 >= -kEdgeSlack && b2 >= -kEdgeSlack && b1 + b2 <= 1.0 + kEdgeSlack && t > least && t < nearest;
    if (hit && isCovered(id, vec2(b1, b2))) {
      nearest = t;
      found = true;
      precise vec3 cross_ = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
      normal = castDot(cross_, ray.direction) > 0.0 ? -cross_ : cross_;
    }
  }
  time = nearest;
  return found;
}

// The face of `voxel` that stands for surface with this normal, as castFace draws it; kHitBack: none looks at the ray.
uint faceTowards(TraversalRay ray, uint voxel, vec3 normal, uint random) {
  uint mask = planes[voxel].x >> 26;
  uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(greaterThan(ray.direction, vec3(0.0)));
  vec3 there = vec3((mask >> facing.x) & 1u, (mask >> facing.y) & 1u, (mask >> facing.z) & 1u);
  vec3 w = there * max(-normal * ray.direction, vec3(0.0));
  if (w.x + w.y + w.z <= 0.0) w = there * abs(ray.direction);
  precise float two = w.x + w.y;
  precise float total = two + w.z;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  uint f = draw < w.x ? facing.x : (draw >= two && w.z > 0.0 ? facing.z : (w.y > 0.0 ? facing.y : facing.x));
  uint face = castFirst[voxel] + uint(bitCount(mask & ((1u << f) - 1u)));
  return total > 0.0 ? face : kHitBack;
}

#endif
