#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer ShownBuffer { uint shown[]; };
layout(set = 0, binding = 1, scalar) readonly buffer NeededBuffer { uint needed[]; };
layout(set = 0, binding = 2, scalar) buffer StatusBuffer { uint status[]; };
layout(push_constant, scalar) uniform Push { uint wordCount; };

void main() {
  uint i = radivoxItemIndex();
  if (i >= wordCount) return;
  if (shown[i] != 0u) atomicAdd(status[0], uint(bitCount(shown[i])));
  if (needed[i] != 0u) atomicAdd(status[1], uint(bitCount(needed[i])));
}
