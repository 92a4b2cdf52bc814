#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// todo = wanted and not yet valid; valid takes them in, since this run makes them so.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer WantedBuffer { uint wanted[]; };
layout(set = 0, binding = 1, scalar) buffer ValidBuffer { uint valid[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer TodoBuffer { uint todo[]; };
layout(push_constant, scalar) uniform Push {
  uint wordCount;
  uint faceCount;
  uint all;  // 1: want every face
};

void main() {
  uint i = radivoxItemIndex();
  if (i >= wordCount) return;
  uint last = faceCount - 32 * i;
  uint bits = all != 0u ? (last >= 32u ? 0xffffffffu : (1u << last) - 1u) : wanted[i];
  uint old = valid[i];
  todo[i] = bits & ~old;
  valid[i] = old | bits;
}
