#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Textures are buffers of sRGB-encoded RGBA8 words, filtered here; colours stay encoded all the way.
#include "viewer/panels.h"

layout(set = 0, binding = 2, scalar) readonly buffer Texels { uint texels[]; };
layout(push_constant, scalar) uniform Push { PanelPush push; };
layout(location = 0) in vec2 uv;
layout(location = 1) in vec4 colour;
layout(location = 0) out vec4 result;

vec4 texel(ivec2 at) {
  at = clamp(at, ivec2(0), ivec2(push.textureWidth, push.textureHeight) - 1);
  return unpackUnorm4x8(texels[uint(at.y) * push.textureWidth + uint(at.x)]);
}

void main() {
  vec2 at = uv * vec2(push.textureWidth, push.textureHeight) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  vec4 top = mix(texel(low), texel(low + ivec2(1, 0)), part.x);
  vec4 bottom = mix(texel(low + ivec2(0, 1)), texel(low + ivec2(1, 1)), part.x);
  result = colour * mix(top, bottom, part.y);
}
