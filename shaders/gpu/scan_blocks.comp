#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Exclusive scan of each block of 1024 items, plus the sum of the blocks before it.
#include "gpu/scan.glsl"

layout(constant_id = 0) const uint kSource = 0u;  // 0: words, 1: pairs of words in place, 2: words in place
layout(set = 0, binding = 0, scalar) readonly buffer Source { uint source[]; };
layout(set = 0, binding = 1, scalar) buffer Destination { uint destination[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Offsets { uvec2 offsets[]; };
layout(push_constant, scalar) uniform Push {
  uint itemCount;
  uint isTop;  // a single block, no offset
};

// In place, reads go through the binding that is written: compilers may take two bindings for two memories, and reorder.
uint readWord(uint i) { return kSource == 0u ? source[i] : destination[i]; }
uvec2 readPair(uint i) { return uvec2(destination[2u * i], destination[2u * i + 1u]); }

void main() {
  const uint block = radivoxGroupIndex();
  if (block >= (itemCount - 1u) / kBlock + 1u) return;
  const uint first = block * kBlock + gl_LocalInvocationIndex * kItemsPerLane;
  const uint end = min(first + kItemsPerLane, itemCount);
  if (kSource == 1u) {
    uvec2 own = uvec2(0u);
    for (uint i = first; i < end; ++i) own = addWide(own, readPair(i));
    uvec2 sum = sumLanesBeforeWide(own);
    if (isTop == 0u) sum = addWide(sum, offsets[block]);
    for (uint i = first; i < end; ++i) {
      const uvec2 item = readPair(i);
      destination[2u * i] = sum.x;
      destination[2u * i + 1u] = sum.y;
      sum = addWide(sum, item);
    }
  } else {
    uint own = 0u;
    for (uint i = first; i < end; ++i) own += readWord(i);
    uint sum = sumLanesBefore(own);
    if (isTop == 0u) sum += offsets[block].x;
    for (uint i = first; i < end; ++i) {
      const uint item = readWord(i);
      destination[i] = sum;
      sum += item;
    }
  }
}
