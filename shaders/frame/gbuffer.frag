#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/scene.h"
#include "shared/texture.glsl"

layout(constant_id = 0) const bool kMasked = false;      // some material has an alpha mask
layout(constant_id = 1) const bool kObeySides = false;   // back faces of single-sided materials are not there
layout(constant_id = 2) const bool kTextured = false;    // some material has a texture

layout(set = 0, binding = 0, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 5, scalar) readonly buffer View { Camera camera; };

layout(location = 0) flat in uint triangle;
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outAlbedo;
layout(location = 3) out vec4 outEmission;
layout(location = 4) out uint outTriangle;

// The camera ray through the pixel's centre. d is not unit.
void cameraRay(out vec3 origin, out vec3 d) {
  vec2 ndc = gl_FragCoord.xy / vec2(camera.width, camera.height) * 2.0 - 1.0;
  if (camera.orthographic == 0u) {
    // Depth 0 is infinitely far, so this is a direction (w = 0), found without any cancellation.
    origin = camera.position;
    d = (camera.inverseViewProjection * vec4(ndc, 0.0, 1.0)).xyz;
  } else {
    // Across the view from the camera: unprojecting the far plane's end of the matrix would cancel kilometres.
    origin = camera.position + ndc.x * camera.inverseViewProjection[0].xyz + ndc.y * camera.inverseViewProjection[1].xyz;
    d = camera.forward;
  }
}

// The triangle's point nearest to b1 e1 + b2 e2. Clamping b1 and b2 would do for a stout triangle; in a needle a hair across is many
// lengths along, and the point would land at its other end.
void nearestInside(vec3 e1, vec3 e2, inout float b1, inout float b2) {
  vec3 p = b1 * e1 + b2 * e2;
  float least = 3.4e38;
  vec2 best = vec2(0.0);
  const vec2 corners[4] = vec2[](vec2(0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(0.0));
  for (uint k = 0u; k < 3u; ++k) {
    vec2 from = corners[k], along = corners[k + 1u] - corners[k];
    vec3 a = from.x * e1 + from.y * e2, edge = along.x * e1 + along.y * e2;
    float length2 = dot(edge, edge);
    float t = length2 > 0.0 ? clamp(dot(p - a, edge) / length2, 0.0, 1.0) : 0.0;
    vec3 miss = p - a - t * edge;
    float distance2 = dot(miss, miss);
    if (distance2 < least) {
      least = distance2;
      best = from + t * along;
    }
  }
  b1 = best.x;
  b2 = best.y;
}

void main() {
  uint i0 = indices[3u * triangle], i1 = indices[3u * triangle + 1u], i2 = indices[3u * triangle + 2u];
  vec3 p0 = vertices[i0].position;
  vec3 e1 = vertices[i1].position - p0, e2 = vertices[i2].position - p0;
  vec3 origin, d;
  cameraRay(origin, d);

  // Barycentrics of the ray's hit (Möller–Trumbore); not clamped yet, so that the derivatives of uv hold across the quad.
  vec3 q = cross(d, e2);
  float determinant = dot(e1, q);
  float inverse = determinant != 0.0 ? 1.0 / determinant : 0.0;
  vec3 s = origin - p0;
  float b1 = dot(s, q) * inverse;
  float b2 = dot(d, cross(s, e1)) * inverse;

  uint material = triangleMaterials[triangle];
  uint flags = materials[material].flags;
  float alpha = materials[material].alpha;
  vec3 albedo = materials[material].albedo;
  vec3 emission = (flags & kMaterialEmissive) != 0u ? materials[material].emission : vec3(0.0);
  if (kTextured) {
    vec2 uvBase = (1.0 - b1 - b2) * vertices[i0].uvBase + b1 * vertices[i1].uvBase + b2 * vertices[i2].uvBase;
    vec2 uvEmissive = (1.0 - b1 - b2) * vertices[i0].uvEmissive + b1 * vertices[i1].uvEmissive + b2 * vertices[i2].uvEmissive;
    vec2 baseX = dFdx(uvBase), baseY = dFdy(uvBase);
    vec2 emissiveX = dFdx(uvEmissive), emissiveY = dFdy(uvEmissive);
    uint base = materials[material].baseTexture;
    if (base != kNoTexture) {
      vec4 texel = sampleTexture(textures[base], uvBase, textureLevel(textures[base], baseX, baseY));
      albedo = min(albedo * texel.rgb, vec3(0.999));
      // Coverage comes from level 0, as in the shadow map: a mask must not thin out in the distance.
      if (kMasked && (flags & kMaterialAlphaMask) != 0u) alpha *= sampleTexture(textures[base], uvBase, 0.0).a;
    }
    uint emissive = materials[material].emissiveTexture;
    if ((flags & kMaterialEmissive) != 0u && emissive != kNoTexture) {
      emission *= sampleTexture(textures[emissive], uvEmissive, textureLevel(textures[emissive], emissiveX, emissiveY)).rgb;
    }
  }

  // The rasterizer's snapping may put the centre a hair outside the triangle.
  if (min(b1, b2) < 0.0 || b1 + b2 > 1.0) nearestInside(e1, e2, b1, b2);
  vec3 position = p0 + b1 * e1 + b2 * e2;
  // Front is where the corners go counter-clockwise; vertex normals only bend the surface's own side.
  vec3 geometric = cross(e1, e2);
  bool front = dot(geometric, d) < 0.0;
  if (!front) geometric = -geometric;
  vec3 normal = (1.0 - b1 - b2) * vertices[i0].normal + b1 * vertices[i1].normal + b2 * vertices[i2].normal;
  float length2 = dot(normal, normal);
  normal = length2 > 1e-12 ? normal * inversesqrt(length2) : normalize(geometric);
  if (dot(normal, geometric) < 0.0) normal = -normal;

  if (kMasked && (flags & kMaterialAlphaMask) != 0u && alpha < materials[material].alphaCutoff) discard;
  if (kObeySides && (flags & kMaterialDoubleSided) == 0u && !front) discard;

  outPosition = vec4(position, dot(position - camera.position, camera.forward));
  outNormal = vec4(normal, 0.0);
  outAlbedo = vec4(albedo, 1.0);
  outEmission = vec4(front ? emission : vec3(0.0), 0.0);
  outTriangle = triangle + 1u;
}
