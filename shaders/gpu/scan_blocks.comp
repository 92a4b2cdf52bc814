#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Exclusive scan of each block of 1024 items, plus the sum of the blocks before it. May work in place.
#include "gpu/scan.glsl"

layout(constant_id = 0) const uint kSource = 0u;  // 0: words, 1: pairs of words
layout(set = 0, binding = 0, scalar) readonly buffer Source { uint source[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Destination { uint destination[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Offsets { uvec2 offsets[]; };
layout(push_constant, scalar) uniform Push {
  uint itemCount;
  uint isTop;  // a single block, no offset
};

void main() {
  const uint block = radivoxGroupIndex();
  if (block >= (itemCount - 1u) / (kLanes * kItemsPerLane) + 1u) return;
  const uint first = (block * kLanes + gl_LocalInvocationIndex) * kItemsPerLane;
  uvec2 items[kItemsPerLane];
  uvec2 own = uvec2(0u);
  for (uint k = 0u; k < kItemsPerLane; ++k) {
    const uint i = first + k;
    items[k] = uvec2(0u);
    if (i < itemCount) items[k] = kSource == 1u ? uvec2(source[2u * i], source[2u * i + 1u]) : uvec2(source[i], 0u);
    own = addWide(own, items[k]);
  }
  uvec2 sum = sumLanesBefore(own);
  if (isTop == 0u) sum = addWide(sum, offsets[block]);
  for (uint k = 0u; k < kItemsPerLane; ++k) {
    const uint i = first + k;
    if (i < itemCount) {
      if (kSource == 1u) {
        destination[2u * i] = sum.x;
        destination[2u * i + 1u] = sum.y;
      } else {
        destination[i] = sum.x;
      }
    }
    sum = addWide(sum, items[k]);
  }
}
