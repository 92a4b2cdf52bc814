#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests/gpu: every lane adds its value to one of a few sums; and the conversions back and forth, value by value.
#include "shared/dispatch.glsl"
#include "shared/fixed_point.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Values { float values[]; };
layout(set = 0, binding = 1, scalar) buffer Sums { uvec2 sums[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Fixed { uvec2 fixedValues[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Back { float back[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Pairs { uvec2 pairs[]; };
layout(push_constant, scalar) uniform Push {
  uint itemCount;
  uint sumCount;
  uint stride;  // odd: lane i takes value i · stride, so that other strides are other orders
  int fractionalBits;
};

void main() {
  const uint i = radivoxItemIndex();
  if (i >= itemCount) return;
  const uint at = (i * stride) % itemCount;
  const uvec2 value = toFixedBits(values[at], fractionalBits);
  fixedValues[at] = value;
  back[at] = fixedToFloatBits(pairs[at], fractionalBits);
  radivoxFixedAtomicAdd(sums[at % sumCount].x, sums[at % sumCount].y, value);
}
