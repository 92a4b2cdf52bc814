// How much of a light a surface point sees, from its shadow map. The includer declares camera, shadowViews[], vertices[], indices[],
// triangleMaterials[], materials[], shadowDepth, shadowTriangle (arrays of layers), kFilter and kMasked.
//
// No depth bias anywhere. Each texel names a surface point P and its triangle. What decides is P's height above the receiver's own
// tangent plane, so slopes need no allowance:
//   the receiver's own triangle, or P at or below the plane  → the texel sees light;
//   P high above the plane                                   → the texel is in shadow;
//   P near the plane (some texels: walls on floors, creases, curved surfaces) → the map is too coarse to tell, so the triangle itself
//   is asked whether it stands between the point and the light.
// From there three ways:
//   rayVisibility       as exactVisibility, but points see what rays through the triangles in the voxels say (shadow_rays.glsl): occluders thinner than
//                       a texel cast their shadows. The map saves rays where one of the triangles it names is in the way, and tells where edges are.
//   exactVisibility     texels only propose occluders; where they disagree, the triangles decide. Edges are as sharp as the geometry,
//                       whatever the map's resolution, and are smoothed over the pixel. For punctual lights.
//   filteredVisibility  the share of texels in a tent. Blurs each of many emitter samples into a penumbra.
// Either way, a place on the receiver's plane that lies behind an occluder standing on it (the other side of a wall) says nothing about
// the point: no light leaks under a wall, and no shadow creeps out on its lit side.
#ifndef RADIVOX_SHADERS_FRAME_SHADOW_GLSL
#define RADIVOX_SHADERS_FRAME_SHADOW_GLSL

#include "shared/shadow_lookup.glsl"
#include "frame/shadow_rays.glsl"

// Visibility of one point from the four texels about it: 0 or 1, or between them where coarse triangles are at the edge.
const int kCandidateReach = 2;
struct PointLookup {
  float seen;
  bool agreed;   // all four texels say the same
  uint ids[4];   // triangles above the receiver's plane, or kNoTexture
};
PointLookup lookUpPoint(Lookup l, vec3 p, vec3 g, uint own) {
  ivec2 first = ivec2(floor(l.centre - 0.5));
  vec2 f = l.centre - 0.5 - vec2(first);
  PointLookup found;
  uint states[4];
  bool anyHidden = false, anyLit = false, anyFar = false;
  vec3 unused;
  [[dont_unroll]] for (uint k = 0u; k < 4u; ++k) {
    states[k] = classifyTexel(l, first + ivec2(k & 1u, k >> 1), p, g, own, 2.0 * l.texel, found.ids[k], unused);
    if (states[k] == kLit) found.ids[k] = kNoTexture;
    anyHidden = anyHidden || states[k] == kHidden;
    anyFar = anyFar || states[k] == kFar;
    anyLit = anyLit || states[k] == kLit || states[k] == kBeside;
  }
  found.agreed = !anyHidden && anyFar != anyLit;
  found.seen = anyHidden ? 0.0 : 1.0;
  if (anyHidden || !anyFar) return found;
  // All in shadow: whether one of these very triangles is in the way does not matter, their neighbours are.
  found.seen = 0.0;
  if (!anyLit) return found;
  // The texels about these may show what stands between them: thin triangles slip through four.
  uint last = kNoTexture;
  [[dont_unroll]] for (int j = -kCandidateReach; j < 2 + kCandidateReach; ++j) {
    [[dont_unroll]] for (int i = -kCandidateReach; i < 2 + kCandidateReach; ++i) {
      ivec2 at = clamp(first + ivec2(i, j), ivec2(0), ivec2(l.resolution - 1));
      uint id = texelFetch(shadowTriangle, ivec3(at + l.tile.xy, l.tile.z), 0).x;
      if (id == 0u || id - 1u == own || id - 1u == last) continue;
      last = id - 1u;
      vec3 p0, e1, e2;
      fetchTriangle(last, p0, e1, e2);
      if (isCoarse(last, e1, e2, l.texel) || !cutsSegment(p0, e1, e2, p, l.toLight, l.tMin, l.tMax)) continue;
      found.seen = 0.0;
      return found;
    }
  }
  [[dont_unroll]] for (uint k = 0u; k < 4u; ++k) {
    if (states[k] == kFar) {
      vec3 p0, e1, e2;
      fetchTriangle(found.ids[k], p0, e1, e2);
      if (isCoarse(found.ids[k], e1, e2, l.texel)) continue;
    }
    found.seen += ((k & 1u) != 0u ? f.x : 1.0 - f.x) * ((k >> 1) != 0u ? f.y : 1.0 - f.y);
  }
  return found;
}

bool anySeparates(PointLookup found, vec3 p, vec3 q, vec3 lift) {
  [[dont_unroll]] for (uint k = 0u; k < 4u; ++k)
    if (found.ids[k] != kNoTexture && separates(found.ids[k], p, q, lift)) return true;
  return false;
}

// The place on the plane through p that the view has `offset` pixels beside p.
vec3 pointOfPixel(vec3 p, vec3 g, vec2 offset, float pixel) {
  vec3 across = normalize(camera.inverseViewProjection[0].xyz), down = normalize(camera.inverseViewProjection[1].xyz);
  vec3 d = camera.orthographic != 0u ? camera.forward : normalize(p - camera.position);
  float slope = dot(d, g);
  slope = abs(slope) > 0.1 ? slope : (slope < 0.0 ? -0.1 : 0.1);  // at grazing angles a pixel is long: at most ten times its width
  vec3 o = (offset.x * across + offset.y * down) * pixel;
  o -= d * (dot(o, g) / slope);
  return p + o - g * dot(o, g);
}

// A look-up for place q beside p. Off a lit point of a hollow surface the plane runs behind the surface: what q meets at once is that.
bool prepareBeside(Light light, vec3 p, vec3 q, bool lit, out Lookup l) {
  bool found = prepareLookup(light, q, l);
  if (lit) l.tMin += 2.0 * length(q - p);
  return found;
}

// Do the corners of a pixel of several texels see what its centre sees, as the map has it?
bool cornersAgree(Light light, vec3 p, vec3 g, uint own, float pixel, float texel, bool seen) {
  bool agreed = true;
  Lookup at;
  [[dont_unroll]] for (uint k = 0u; k < 4u && agreed && pixel > texel; ++k) {
    vec3 q = pointOfPixel(p, g, vec2(k & 1u, k >> 1) - 0.5, pixel);
    uint id, state = kLit;
    vec3 unused;
    if (prepareBeside(light, p, q, seen, at)) state = classifyTexel(at, ivec2(floor(at.centre)), q, g, own, 2.0 * at.texel, id, unused);
    agreed = (state == kLit || state == kBeside) == seen;
  }
  return agreed;
}

// Sample k of those that a pixel with an edge in it takes, pixels from its centre.
const uint kEdgeSamples = 8u;
vec2 edgeSample(uint k) {
  return vec2(float(k) / float(kEdgeSamples), float(bitfieldReverse(k) >> 8) / 16777216.0) + 0.5 / float(kEdgeSamples) - 0.5;
}

// Share of the pixel that sees `light`. viewDepth: p's distance along the view axis.
float exactVisibility(Light light, vec3 p, vec3 g, uint own, float viewDepth) {
  Lookup l, at;
  if (!prepareLookup(light, p, l)) return 1.0;
  PointLookup centre = lookUpPoint(l, p, g, own);
  float pixel = camera.pixelAngle * (camera.orthographic != 0u ? 1.0 : viewDepth);
  bool agreed = centre.agreed && cornersAgree(light, p, g, own, pixel, l.texel, centre.seen > 0.0);
  if (agreed) return centre.seen;

  vec3 lift = 2.0 * l.slack * g;
  float seen = 0.0, total = 0.0;
  [[dont_unroll]] for (uint k = 0u; k < kEdgeSamples; ++k) {
    vec3 q = pointOfPixel(p, g, edgeSample(k), pixel);
    float v = 1.0;
    if (prepareBeside(light, p, q, centre.seen > 0.0, at)) {
      PointLookup there = lookUpPoint(at, q, g, own);
      v = there.seen;
      if (v != centre.seen && (anySeparates(there, p, q, lift) || anySeparates(centre, p, q, lift))) continue;
    }
    seen += v;
    total += 1.0;
  }
  return total > 0.0 ? seen / total : centre.seen;
}

// Does one of the triangles that the map names stand between p and the light? Without holes, that is.
bool isBlockedByNamed(PointLookup found, Lookup l, vec3 p) {
  uint last = kNoTexture;
  [[dont_unroll]] for (uint k = 0u; k < 4u; ++k) {
    uint id = found.ids[k];
    if (id == kNoTexture || id == last) continue;
    last = id;
    if (kMasked && (materials[triangleMaterials[id]].flags & kMaterialAlphaMask) != 0u) continue;
    vec3 p0, e1, e2;
    fetchTriangle(id, p0, e1, e2);
    if (cutsSegment(p0, e1, e2, p, l.toLight, l.tMin, l.tMax)) return true;
  }
  return false;
}

// Share of the pixel that sees `light`, by rays.
float rayVisibility(Light light, vec3 p, vec3 g, uint own, float viewDepth) {
  bool parallel = light.type == kLightDirectional;
  vec3 toLight = parallel ? -light.direction : light.position - p;
  float distance_ = parallel ? 3.4e38 : length(toLight) * 0.999;
  float pixel = camera.pixelAngle * (camera.orthographic != 0u ? 1.0 : viewDepth);
  PointLookup map;
  map.agreed = false;
  float seen = 0.0;
  bool isKnown = false;
  Lookup l;
  if (prepareLookup(light, p, l)) {
    map = lookUpPoint(l, p, g, own);
    map.agreed = map.agreed && cornersAgree(light, p, g, own, pixel, l.texel, map.seen > 0.0);
    isKnown = map.agreed && map.seen == 0.0 && isBlockedByNamed(map, l, p);
  }
  if (!isKnown) {
    uint centre = castShadowRay(p, g, normalize(toLight), distance_, own);
    if (centre == kRayUnknown) return exactVisibility(light, p, g, own, viewDepth);
    seen = centre == kRayFree ? 1.0 : 0.0;
  }
  if (map.agreed && map.seen == seen) return seen;

  float sum = 0.0, total = 0.0;
  [[dont_unroll]] for (uint k = 0u; k < kEdgeSamples; ++k) {
    vec3 q = pointOfPixel(p, g, edgeSample(k), pixel);
    vec3 way = parallel ? toLight : light.position - q;
    uint beside = castBeside(p, q, g, own);
    uint there = beside == kRayFree ? castShadowRay(q, g, normalize(way), parallel ? distance_ : length(way) * 0.999, own) : beside;
    if (there == kRayUnknown) return exactVisibility(light, p, g, own, viewDepth);
    if (beside == kRayBlocked) continue;
    sum += there == kRayFree ? 1.0 : 0.0;
    total += 1.0;
  }
  return total > 0.0 ? sum / total : seen;
}

// Distinct triangles of a filter's shadowed texels: the first few stand for all.
const uint kMaxOccluders = 4u;

// Share in [0, 1] of the texels within a tent that see `light` from p. g: geometric normal on the light's side; own: p's triangle.
// The tent's half width is kFilter texels (0: the nearest texel alone), or less for an emitter sample that stands for a patch of side
// `spread` (m): as wide as the shadow that one patch's edge is smeared over by the next, given where the occluders are.
const uint kReach = kFilter > 0u ? kFilter : 1u;
float filteredVisibility(Light light, vec3 p, vec3 g, uint own, float spread) {
  Lookup l;
  if (!prepareLookup(light, p, l)) return 1.0;
  const uint side = 2u * kReach;
  ivec2 first = ivec2(floor(l.centre - 0.5 - float(kReach))) + 1;
  float nearHeight = 2.0 * float(kReach) * l.texel;
  uint id;
  vec3 occluder;

  // The corners and the middle first: mostly they agree, and speak for all.
  float litCount = 0.0, farCount = 0.0, distances = 0.0;
  [[dont_unroll]] for (uint k = 0u; k < 8u; ++k) {
    uvec2 at = uvec2(k & 1u, (k >> 1) & 1u);
    at = k < 4u ? at * (side - 1u) : at + kReach - 1u;
    uint state = classifyTexel(l, first + ivec2(at), p, g, own, nearHeight, id, occluder);
    if (state == kHidden) return 0.0;
    if (state == kFar) {
      farCount += 1.0;
      distances += distance(occluder, light.position);
    } else {
      litCount += 1.0;
    }
  }
  if (litCount == 0.0) return 0.0;
  if (farCount == 0.0) return 1.0;
  float halfWidth = float(kReach);
  if (!l.parallel && spread > 0.0) {
    float toOccluder = max(distances / farCount, 1e-3 * l.tMax);
    halfWidth = clamp(spread * max(l.tMax - toOccluder, 0.0) / (toOccluder * l.texel), 1.0, halfWidth);
  }

  float seen = 0.0, total = 0.0;
  uint litBits[2] = uint[2](0u, 0u);  // a bit per texel of the filter, 36 at most
  uint occluders[kMaxOccluders];
  uint occluderCount = 0u;
  [[dont_unroll]] for (uint k = 0u; k < side * side; ++k) {
    ivec2 at = first + ivec2(k % side, k / side);
    vec2 offset = abs(vec2(at) + 0.5 - l.centre);
    vec2 tent = kFilter == 0u ? vec2(lessThanEqual(offset, vec2(0.5))) : max(vec2(0.0), 1.0 - offset / halfWidth);
    uint state = classifyTexel(l, at, p, g, own, nearHeight, id, occluder);
    if (state == kHidden) return 0.0;
    total += tent.x * tent.y;
    if (state != kFar) {
      seen += tent.x * tent.y;
      litBits[k / 32u] |= 1u << (k % 32u);
      continue;
    }
    bool known = false;
    [[dont_unroll]] for (uint i = 0u; i < occluderCount; ++i) known = known || occluders[i] == id;
    if (!known && occluderCount < kMaxOccluders) occluders[occluderCount++] = id;
  }
  // Texels of no weight must not make a point dark that they do not reach.
  if (occluderCount == 0u || seen == total) return 1.0;

  // Texels disagree. Where on the receiver's plane is each, and does an occluder stand between that place and p?
  float validSeen = 0.0, valid = 0.0;
  vec3 lift = 2.0 * l.slack * g;
  [[dont_unroll]] for (uint k = 0u; k < side * side; ++k) {
    ivec2 at = first + ivec2(k % side, k / side);
    vec2 offset = abs(vec2(at) + 0.5 - l.centre);
    vec2 tent = kFilter == 0u ? vec2(lessThanEqual(offset, vec2(0.5))) : max(vec2(0.0), 1.0 - offset / halfWidth);
    float weight = tent.x * tent.y;
    if (weight == 0.0) continue;
    vec3 q = unproject(l.view, (vec2(at) + 0.5) / float(l.resolution) * 2.0 - 1.0, l.depth);
    vec3 d = l.parallel ? light.direction : q - light.position;
    float slope = dot(d, g);
    if (slope < 0.0) q += d * (dot(p - q, g) / slope);
    bool apart = false;
    [[dont_unroll]] for (uint i = 0u; i < occluderCount && !apart; ++i) apart = separates(occluders[i], p, q, lift);
    if (apart) continue;
    valid += weight;
    if ((litBits[k / 32u] >> (k % 32u) & 1u) != 0u) validSeen += weight;
  }
  if (valid > 0.0) return validSeen / valid;
  [[dont_unroll]] for (uint i = 0u; i < occluderCount; ++i) {
    vec3 p0, e1, e2;
    fetchTriangle(occluders[i], p0, e1, e2);
    if (cutsSegment(p0, e1, e2, p, l.toLight, l.tMin, l.tMax)) return 0.0;
  }
  return 1.0;
}

#endif
