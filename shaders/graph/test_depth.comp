// For tests of the executor: target[i] = depth image's texel i of layer 0, row by row, through a sampler.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform sampler2D depthImage;
layout(set = 0, binding = 1, scalar) buffer Target { float target[]; };

void main() {
  uint i = radivoxItemIndex();
  uvec2 size = uvec2(textureSize(depthImage, 0));
  if (i < size.x * size.y) target[i] = texelFetch(depthImage, ivec2(i % size.x, i / size.x), 0).x;
}
