#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/dispatch.glsl"
#include "shared/texture.glsl"

// For tests: reads one texture at many places.
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Places { vec3 places[]; };  // u, v, level
layout(set = 0, binding = 2, scalar) writeonly buffer Colors { vec4 colors[]; };
layout(push_constant, scalar) uniform Push {
  uint placeCount;
  uint texture_;
};

void main() {
  uint i = radivoxItemIndex();
  if (i >= placeCount) return;
  colors[i] = sampleTexture(textures[texture_], places[i].xy, places[i].z);
}
