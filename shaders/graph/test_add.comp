// For tests of the executor: target[i] = source[i] + amount. source and target may be the same buffer.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) buffer Source { uint source[]; };
layout(set = 0, binding = 1, scalar) buffer Target { uint target[]; };
layout(push_constant) uniform Push {
  uint itemCount;
  uint amount;
};

void main() {
  uint i = radivoxItemIndex();
  if (i < itemCount) target[i] = source[i] + amount;
}
