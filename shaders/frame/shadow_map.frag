#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/scene.h"
#include "shared/texture.glsl"

// Writes id + 1 of the surface; depth is the fixed-function depth of the true surface, without any bias.
layout(constant_id = 0) const bool kMasked = false;      // some material has an alpha mask
layout(constant_id = 1) const bool kObeySides = false;   // back faces of single-sided materials cast no shadow

layout(set = 0, binding = 0, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 5, scalar) readonly buffer ShadowViews { ShadowView shadowViews[]; };

layout(push_constant, scalar) uniform Push { uint view; };

layout(location = 0) flat in uint triangle;
layout(location = 1) in vec2 uv;
layout(location = 0) out uint idPlusOne;

bool seenFromBack() {
  vec3 p0 = vertices[indices[3u * triangle]].position;
  vec3 normal = cross(vertices[indices[3u * triangle + 1u]].position - p0, vertices[indices[3u * triangle + 2u]].position - p0);
  // Towards the light: from p0 to the eye point, or for a parallel view against the direction of travel (z falls away from the light).
  mat4 m = shadowViews[view].viewProjection;
  bool parallel = m[0][3] == 0.0 && m[1][3] == 0.0 && m[2][3] == 0.0;
  vec3 toLight = parallel ? shadowViews[view].inverseViewProjection[2].xyz : shadowViews[view].origin - p0;
  return dot(normal, toLight) < 0.0;
}

void main() {
  idPlusOne = triangle + 1u;
  if (!kMasked && !kObeySides) return;
  uint material = triangleMaterials[triangle];
  uint flags = materials[material].flags;
  if (kMasked && (flags & kMaterialAlphaMask) != 0u) {
    float alpha = materials[material].alpha;
    uint base = materials[material].baseTexture;
    // Level 0: a mask must not thin out in the distance.
    if (base != kNoTexture) alpha *= sampleTexture(textures[base], uv, 0.0).a;
    if (alpha < materials[material].alphaCutoff) discard;
  }
  if (kObeySides && (flags & kMaterialDoubleSided) == 0u && seenFromBack()) discard;
}
