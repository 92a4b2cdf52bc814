// What one texel of a shadow map says about a point. No depth bias: the texel names a surface point P and its triangle, and P's height above
// the receiver's own tangent plane decides. The includer declares shadowViews[], vertices[], indices[], triangleMaterials[], materials[],
// shadowDepth, shadowTriangle (arrays of layers) and kMasked.
#ifndef RADIVOX_SHADERS_SHARED_SHADOW_LOOKUP_GLSL
#define RADIVOX_SHADERS_SHARED_SHADOW_LOOKUP_GLSL
#include "shared/scene.h"

// The view of the light that sees p, or false. `clip` is p in that view.
bool findShadowView(Light light, vec3 p, out uint view, out vec4 clip) {
  [[dont_unroll]] for (uint i = 0u; i < light.shadowViewCount; ++i) {
    view = light.firstShadowView + i;
    clip = shadowViews[view].viewProjection * vec4(p, 1.0);
    // Views of a light meet at their edges; the allowance closes the gap that rounding may leave.
    if (clip.w > 0.0 && max(abs(clip.x), abs(clip.y)) <= clip.w * 1.00001) return true;
  }
  return false;
}

// Does the triangle cut the segment p + t d, tMin < t < tMax? The edge allowance closes seams between neighbours.
bool cutsSegment(vec3 p0, vec3 e1, vec3 e2, vec3 p, vec3 d, float tMin, float tMax) {
  vec3 q = cross(d, e2);
  float determinant = dot(e1, q);
  if (determinant == 0.0) return false;
  float inverse = 1.0 / determinant;
  vec3 s = p - p0;
  float b1 = dot(s, q) * inverse;
  vec3 r = cross(s, e1);
  float b2 = dot(d, r) * inverse;
  float t = dot(e2, r) * inverse;
  return b1 >= -1e-5 && b2 >= -1e-5 && b1 + b2 <= 1.00001 && t > tMin && t < tMax;
}

vec3 unproject(uint view, vec2 ndc, float depth) {
  vec4 p = shadowViews[view].inverseViewProjection * vec4(ndc, depth, 1.0);
  return p.xyz / p.w;
}

void fetchTriangle(uint id, out vec3 p0, out vec3 e1, out vec3 e2) {
  p0 = vertices[indices[3u * id]].position;
  e1 = vertices[indices[3u * id + 1u]].position - p0;
  e2 = vertices[indices[3u * id + 2u]].position - p0;
}

// Triangles that stand for more than themselves: smaller than a texel (neighbours that the map missed), or with holes in them. The map,
// not their outline, says what they hide.
bool isCoarse(uint id, vec3 e1, vec3 e2, float texel) {
  if (kMasked && (materials[triangleMaterials[id]].flags & kMaterialAlphaMask) != 0u) return true;
  return max(dot(e1, e1), max(dot(e2, e2), dot(e2 - e1, e2 - e1))) < texel * texel;
}

// Does triangle `id` stand on the plane between p and q, both lifted a little off it?
bool separates(uint id, vec3 p, vec3 q, vec3 lift) {
  vec3 p0, e1, e2;
  fetchTriangle(id, p0, e1, e2);
  return cutsSegment(p0, e1, e2, p + lift, q - p, 0.0, 1.0);
}

// What a look-up needs to know of the light, the view and the receiver.
struct Lookup {
  uint view;
  int resolution;
  ivec3 tile;     // first texel, layer
  vec2 centre;    // the point in the tile, texels
  float depth;    // its own
  bool parallel;
  vec3 toLight;   // unit
  float tMax;     // the light's distance
  float texel;    // m, at the point
  float slack;    // m, rounding of what the map stores
  float tMin;     // m, rounding of the point: nothing nearer hides it
};

bool prepareLookup(Light light, vec3 p, out Lookup l) {
  vec4 clip;
  if (!findShadowView(light, p, l.view, clip)) return false;
  l.resolution = int(shadowViews[l.view].resolution);
  l.tile = ivec3(shadowViews[l.view].offsetX, shadowViews[l.view].offsetY, shadowViews[l.view].layer);
  l.centre = (clip.xy / clip.w * 0.5 + 0.5) * float(l.resolution);
  l.depth = clip.z / clip.w;
  l.parallel = light.type == kLightDirectional;
  vec3 toLight = l.parallel ? -light.direction : light.position - p;
  l.tMax = l.parallel ? 3.4e38 : length(toLight) * 0.999;
  l.toLight = normalize(toLight);
  l.texel = sqrt(shadowViews[l.view].texelFlux) * (l.parallel ? 1.0 : clip.w);
  vec3 size = abs(p);
  l.tMin = 4e-6 * (max(size.x, max(size.y, size.z)) + l.texel);
  l.slack = 0.01 * l.texel + l.tMin;
  return true;
}

const uint kLit = 0u;      // nothing above the receiver's plane
const uint kBeside = 1u;   // an occluder near the plane, but not between the point and the light
const uint kHidden = 2u;   // an occluder near the plane, between the point and the light
const uint kFar = 3u;      // an occluder high above the plane

// What texel `at` of the tile says about p; id, occluder: its triangle and point, unless kLit.
uint classifyTexel(Lookup l, ivec2 at, vec3 p, vec3 g, uint own, float nearHeight, out uint id, out vec3 occluder) {
  id = 0u;
  if (l.resolution == 0) return kLit;  // a view that no face is in has no texels
  at = clamp(at, ivec2(0), ivec2(l.resolution - 1));
  ivec3 where = ivec3(at + l.tile.xy, l.tile.z);
  id = texelFetch(shadowTriangle, where, 0).x;
  if (id == 0u || id - 1u == own) return kLit;
  id -= 1u;
  occluder = unproject(l.view, (vec2(at) + 0.5) / float(l.resolution) * 2.0 - 1.0, texelFetch(shadowDepth, where, 0).x);
  float height = dot(occluder - p, g);
  if (height <= l.slack) return kLit;
  if (height >= nearHeight) return kFar;
  vec3 p0, e1, e2;
  fetchTriangle(id, p0, e1, e2);
  if (isCoarse(id, e1, e2, l.texel)) return height < 0.5 * nearHeight ? kBeside : kFar;
  return cutsSegment(p0, e1, e2, p, l.toLight, l.tMin, l.tMax) ? kHidden : kBeside;
}

#endif
