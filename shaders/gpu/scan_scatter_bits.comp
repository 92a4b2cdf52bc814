#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
// Writes the indices of the set bits in order. By address, since where a block's indices go depends on the data: a list longer than a
// binding can show cannot be split into bindings beforehand.
#include "gpu/scan.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Indices { uint index[]; };
layout(set = 0, binding = 0, scalar) readonly buffer Bits { uint bits[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Offsets { uvec2 offsets[]; };
layout(push_constant, scalar) uniform Push {
  Indices indices;
  uint capacity;      // indices that the output holds
  uint firstWord;     // of this binding in all of the bits
  uint wordCount;     // in this binding
  uint lastWordMask;
  uint isTop;         // a single block, no offset
};

uint readWord(uint i) { return bits[i] & (i + 1u == wordCount ? lastWordMask : 0xffffffffu); }

void main() {
  const uint block = radivoxGroupIndex();
  if (block >= (wordCount - 1u) / kBlock + 1u) return;
  const uint first = block * kBlock + gl_LocalInvocationIndex * kItemsPerLane;
  const uint end = min(first + kItemsPerLane, wordCount);
  uint own = 0u;
  for (uint i = first; i < end; ++i) own += bitCount(readWord(i));
  uint at = sumLanesBefore(own) + (isTop == 0u ? offsets[block].x : 0u);
  for (uint i = first; i < end; ++i) {
    for (uint word = readWord(i); word != 0u; word &= word - 1u) {
      if (at < capacity) indices.index[at] = (firstWord + i) * 32u + uint(findLSB(word));
      ++at;
    }
  }
}
