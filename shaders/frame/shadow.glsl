// How much of a light a surface point sees, from its shadow map. The includer declares shadowViews[], vertices[], indices[],
// shadowDepth, shadowTriangle (arrays of layers) and kFilter.
//
// No depth bias anywhere. Each texel of the filter names a surface point P and its triangle. What decides is P's height above the
// receiver's own tangent plane, so slopes need no allowance:
//   the receiver's own triangle, or P at or below the plane  → the texel sees light;
//   P high above the plane                                   → the texel is in shadow;
//   P near the plane (some texels: walls on floors, creases, curved surfaces) → the map is too coarse to tell, so the triangle itself
//   is asked whether it stands between the point and the light. If so the point is dark whatever the other texels say.
// Where texels disagree, those whose place on the receiver's plane lies behind an occluder that stands on it (the other side of a
// wall) say nothing about the point and are left out: no light leaks under a wall, and no shadow creeps out on its lit side.
#ifndef RADIVOX_SHADERS_FRAME_SHADOW_GLSL
#define RADIVOX_SHADERS_FRAME_SHADOW_GLSL

// The view of the light that sees p, or false. `clip` is p in that view.
bool findShadowView(Light light, vec3 p, out uint view, out vec4 clip) {
  for (uint i = 0u; i < light.shadowViewCount; ++i) {
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

// Distinct triangles of a filter's shadowed texels: the first few stand for all.
const uint kMaxOccluders = 4u;
struct Occluders {
  uint ids[kMaxOccluders];
  uint count;
};
void addOccluder(inout Occluders o, uint id) {
  for (uint i = 0u; i < o.count; ++i)
    if (o.ids[i] == id) return;
  if (o.count < kMaxOccluders) o.ids[o.count++] = id;
}
bool anyCutsSegment(Occluders o, vec3 p, vec3 d, float tMin, float tMax) {
  for (uint i = 0u; i < o.count; ++i) {
    vec3 p0, e1, e2;
    fetchTriangle(o.ids[i], p0, e1, e2);
    if (cutsSegment(p0, e1, e2, p, d, tMin, tMax)) return true;
  }
  return false;
}

// A tent of half width kFilter texels; 0: the nearest texel decides, its neighbours are still asked about contact.
const uint kReach = kFilter > 0u ? kFilter : 1u;
float tentWeight(ivec2 texel, vec2 centre) {
  vec2 offset = abs(vec2(texel) + 0.5 - centre);
  vec2 tent = kFilter == 0u ? vec2(lessThanEqual(offset, vec2(0.5))) : max(vec2(0.0), 1.0 - offset / float(kReach));
  return tent.x * tent.y;
}

// Share in [0, 1] of the filter's texels that see `light` from p. g: geometric normal on the light's side; own: p's triangle.
float shadowVisibility(Light light, vec3 p, vec3 g, uint own) {
  uint view;
  vec4 clip;
  if (!findShadowView(light, p, view, clip)) return 1.0;
  int resolution = int(shadowViews[view].resolution);
  ivec3 tile = ivec3(shadowViews[view].offsetX, shadowViews[view].offsetY, shadowViews[view].layer);
  vec2 centre = (clip.xy / clip.w * 0.5 + 0.5) * float(resolution);
  ivec2 first = ivec2(floor(centre - 0.5 - float(kReach))) + 1;
  bool parallel = light.type == kLightDirectional;
  vec3 toLight = parallel ? -light.direction : light.position - p;
  float tMax = parallel ? 3.4e38 : length(toLight) * 0.999;
  toLight = normalize(toLight);
  float texel = sqrt(shadowViews[view].texelFlux) * (parallel ? 1.0 : clip.w);  // m, at p
  float nearHeight = float(2u * kReach) * texel;
  vec3 size = abs(p);
  float slack = 0.01 * texel + 4e-6 * (max(size.x, max(size.y, size.z)) + texel);  // rounding of p and P

  float seen = 0.0, total = 0.0;
  uint seenBits[2] = uint[2](0u, 0u);  // a bit per texel of the filter, 36 at most
  Occluders occluders;
  occluders.count = 0u;
  for (uint k = 0u; k < 4u * kReach * kReach; ++k) {
    ivec2 at = first + ivec2(k % (2u * kReach), k / (2u * kReach));
    float weight = tentWeight(at, centre);
    total += weight;
    at = clamp(at, ivec2(0), ivec2(resolution - 1));
    ivec3 where = ivec3(at + tile.xy, tile.z);
    uint id = texelFetch(shadowTriangle, where, 0).x;
    bool lit = id == 0u || id - 1u == own;
    if (!lit) {
      id -= 1u;
      vec3 occluder = unproject(view, (vec2(at) + 0.5) / float(resolution) * 2.0 - 1.0, texelFetch(shadowDepth, where, 0).x);
      float height = dot(occluder - p, g);
      lit = height <= slack;
      if (!lit && height < nearHeight) {
        vec3 p0, e1, e2;
        fetchTriangle(id, p0, e1, e2);
        if (cutsSegment(p0, e1, e2, p, toLight, slack, tMax)) return 0.0;
        // A triangle smaller than a texel stands for neighbours that the map missed: trust the height instead.
        bool speck = max(dot(e1, e1), max(dot(e2, e2), dot(e2 - e1, e2 - e1))) < texel * texel;
        lit = !speck || height < float(kReach) * texel;
      }
      if (!lit) addOccluder(occluders, id);
    }
    if (lit) {
      seen += weight;
      seenBits[k / 32u] |= 1u << (k % 32u);
    }
  }
  if (seen <= 0.0) return 0.0;
  if (occluders.count == 0u) return 1.0;

  // Texels disagree. Where on the receiver's plane is each, and does an occluder stand between that place and p?
  float validSeen = 0.0, valid = 0.0;
  for (uint k = 0u; k < 4u * kReach * kReach; ++k) {
    ivec2 at = first + ivec2(k % (2u * kReach), k / (2u * kReach));
    vec3 q = unproject(view, (vec2(at) + 0.5) / float(resolution) * 2.0 - 1.0, clip.z / clip.w);
    vec3 d = parallel ? light.direction : q - light.position;
    float slope = dot(d, g);
    if (slope < 0.0) q += d * (dot(p - q, g) / slope);
    if (anyCutsSegment(occluders, p + 2.0 * slack * g, q - p, 0.0, 1.0)) continue;
    float weight = tentWeight(at, centre);
    valid += weight;
    if ((seenBits[k / 32u] >> (k % 32u) & 1u) != 0u) validSeen += weight;
  }
  if (valid > 0.0) return validSeen / valid;
  return anyCutsSegment(occluders, p, toLight, slack, tMax) ? 0.0 : 1.0;
}

#endif
