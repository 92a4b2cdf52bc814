#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sums each block of 1024 items.
#include "gpu/scan.glsl"

layout(constant_id = 0) const uint kSource = 0u;  // 0: words, 1: pairs of words, 2: words of bits to count
layout(set = 0, binding = 0, scalar) readonly buffer Source { uint source[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Sums { uvec2 sums[]; };
layout(push_constant, scalar) uniform Push {
  uint itemCount;
  uint lastWordMask;  // bits: those of the last word that count
};

void main() {
  const uint block = radivoxGroupIndex();
  if (block >= (itemCount - 1u) / kBlock + 1u) return;
  const uint first = block * kBlock + gl_LocalInvocationIndex * kItemsPerLane;
  const uint end = min(first + kItemsPerLane, itemCount);
  if (kSource == 2u) {
    uint own = 0u;  // at most 32 · 1024
    for (uint i = first; i < end; ++i) own += bitCount(source[i] & (i + 1u == itemCount ? lastWordMask : 0xffffffffu));
    const uint before = sumLanesBefore(own);
    if (gl_LocalInvocationIndex == kLanes - 1u) sums[block] = uvec2(before + own, 0u);
  } else {
    uvec2 own = uvec2(0u);
    for (uint i = first; i < end; ++i) {
      own = addWide(own, kSource == 1u ? uvec2(source[2u * i], source[2u * i + 1u]) : uvec2(source[i], 0u));
    }
    const uvec2 before = sumLanesBeforeWide(own);
    if (gl_LocalInvocationIndex == kLanes - 1u) sums[block] = addWide(before, own);
  }
}
