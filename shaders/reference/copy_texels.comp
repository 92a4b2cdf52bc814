#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/dispatch.glsl"
#include "shared/texture.glsl"

// Level 0 of one texture, from behind its device address to a buffer that the host can read.
layout(local_size_x = 256) in;
layout(set = 0, binding = 0, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Texels { uint copied[]; };
layout(push_constant, scalar) uniform Push {
  uint texelCount;
  uint index;
};

void main() {
  uint i = radivoxItemIndex();
  if (i < texelCount) copied[i] = TextureTexels(textures[index].address).texels[i];
}
