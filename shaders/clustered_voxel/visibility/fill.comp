#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Writes the rows of a chunk, one after the other, and where each begins. Words that two rows share come out the same in any order.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "shared/visibility_row.h"
layout(set = 0, binding = 0, scalar) readonly buffer Table { uint table[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Offsets { uint offsets[]; };  // kRowsPerChunk + 1
layout(set = 0, binding = 2, scalar) buffer RowBits { uint words[]; };  // of this chunk, all 0
layout(set = 0, binding = 3, scalar) writeonly buffer RowStart { uint rowStart[]; };
layout(push_constant, scalar) uniform Push {
  uint rowCount;
  uint tableBits;
  uint firstRowStart;
  uint idCount;  // C + F
};
#include "shared/dispatch.glsl"

void putBits(uint at, uvec2 bits) {
  uint word = at >> 5;
  uint shift = at & 31u;
  atomicOr(words[word], bits.x << shift);
  uint second = bits.y << shift | (shift == 0u ? 0u : bits.x >> (32u - shift));
  uint third = shift == 0u ? 0u : bits.y >> (32u - shift);
  if (second != 0u) atomicOr(words[word + 1u], second);
  if (third != 0u) atomicOr(words[word + 2u], third);
}

void main() {
  uint row = radivoxItemIndex();
  if (row > kRowsPerChunk) return;
  uint at = offsets[row];
  rowStart[firstRowStart + row] = at;
  if (row >= rowCount) return;
  uint next = 0u;
  for (uint slot = row << tableBits; table[slot] != kEmptySlot; ++slot) {
    uint entry = table[slot];
    uint id = rowId(entry & kEntryIdMask, idCount);
    uint count = (entry >> 24) + 1u;
    putBits(at, encodeRowEntry(id - next, count));
    at += rowEntryBits(id - next, count);
    next = id + 1u;
  }
}
