// How much of a light a surface point sees, from its shadow map. The includer declares shadowViews[], vertices[], indices[],
// shadowDepth, shadowTriangle (arrays of layers) and kFilter.
//
// No depth bias anywhere. Each texel of the filter names a surface point P and its triangle. What decides is P's height above the
// receiver's own tangent plane, so slopes need no allowance:
//   the receiver's own triangle, or P at or below the plane  → the texel sees light;
//   P high above the plane                                   → the texel is in shadow;
//   P near the plane (some texels: walls on floors, creases, curved surfaces) → the map is too coarse to tell, so the triangle itself
//   is asked whether it stands between the point and the light. If so the point is dark whatever the other texels say: no light leaks under
//   a wall, and shadows start where things touch.
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

// Share in [0, 1] of the filter's texels that see `light` from p. g: geometric normal on the light's side; own: p's triangle.
float shadowVisibility(Light light, vec3 p, vec3 g, uint own) {
  uint view;
  vec4 clip;
  if (!findShadowView(light, p, view, clip)) return 1.0;
  ShadowView v = shadowViews[view];
  float resolution = float(v.resolution);
  vec2 centre = (clip.xy / clip.w * 0.5 + 0.5) * resolution;
  bool parallel = light.type == kLightDirectional;
  vec3 toLight = parallel ? -light.direction : light.position - p;
  float distanceToLight = parallel ? 1.0 : length(toLight);
  toLight /= distanceToLight;
  float texel = sqrt(v.texelFlux) * (parallel ? 1.0 : clip.w);  // m, at p

  // A tent of half width kFilter texels; 0: the nearest texel decides, its neighbours are still asked about contact.
  uint reach = max(kFilter, 1u);
  ivec2 first = ivec2(floor(centre - 0.5 - float(reach))) + 1;
  float nearHeight = float(2u * reach) * texel;
  vec3 size = abs(p);
  float slack = 0.01 * texel + 4e-6 * (max(size.x, max(size.y, size.z)) + texel);  // rounding of p and P
  float tMax = parallel ? 3.4e38 : distanceToLight * 0.999;

  float seen = 0.0, total = 0.0;
  for (uint j = 0u; j < 2u * reach; ++j) {
    for (uint i = 0u; i < 2u * reach; ++i) {
      ivec2 at = first + ivec2(i, j);
      vec2 offset = abs(vec2(at) + 0.5 - centre);
      vec2 tent = kFilter == 0u ? vec2(lessThanEqual(offset, vec2(0.5))) : max(vec2(0.0), 1.0 - offset / float(reach));
      float weight = tent.x * tent.y;
      total += weight;

      at = clamp(at, ivec2(0), ivec2(v.resolution) - 1);
      ivec3 where = ivec3(at + ivec2(v.offsetX, v.offsetY), v.layer);
      uint id = texelFetch(shadowTriangle, where, 0).x;
      if (id == 0u || id - 1u == own) {
        seen += weight;
        continue;
      }
      float depth = texelFetch(shadowDepth, where, 0).x;
      vec4 unprojected = v.inverseViewProjection * vec4((vec2(at) + 0.5) / resolution * 2.0 - 1.0, depth, 1.0);
      float height = dot(unprojected.xyz / unprojected.w - p, g);
      if (height <= slack) {
        seen += weight;
      } else if (height < nearHeight) {
        id -= 1u;
        vec3 p0 = vertices[indices[3u * id]].position;
        vec3 e1 = vertices[indices[3u * id + 1u]].position - p0;
        vec3 e2 = vertices[indices[3u * id + 2u]].position - p0;
        if (cutsSegment(p0, e1, e2, p, toLight, slack, tMax)) return 0.0;
        // A triangle smaller than a texel stands for neighbours that the map missed: trust the height instead.
        bool speck = max(dot(e1, e1), max(dot(e2, e2), dot(e2 - e1, e2 - e1))) < texel * texel;
        if (!speck || height < float(reach) * texel) seen += weight;
      }
    }
  }
  return total > 0.0 ? seen / total : 1.0;
}

#endif
