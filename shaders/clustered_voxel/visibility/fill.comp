#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Writes the rows of a chunk, one after the other, and where each begins.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
layout(set = 0, binding = 0, scalar) readonly buffer Table { uint table[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Offsets { uint offsets[]; };  // kRowsPerChunk + 1
layout(set = 0, binding = 2, scalar) writeonly buffer Entries { uint entries[]; };  // of this chunk
layout(set = 0, binding = 3, scalar) writeonly buffer RowStart { uint rowStart[]; };
layout(push_constant, scalar) uniform Push {
  uint rowCount;
  uint tableBits;
  uint firstRowStart;
};
#include "shared/dispatch.glsl"

void main() {
  uint row = radivoxItemIndex();
  if (row > kRowsPerChunk) return;
  uint next = offsets[row];
  rowStart[firstRowStart + row] = next;
  if (row >= rowCount) return;
  uint base = row << tableBits;
  uint end = offsets[row + 1u];
  for (uint slot = 0u; next < end; ++slot) {
    uint entry = table[base + slot];
    if (entry != kEmptySlot) entries[next++] = entry;
  }
}
