// Reading visibility rows: chunks of bits by device address (layout: shaders/shared/visibility_row.h).
#ifndef RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#define RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/visibility_row.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RowBits { uvec3 words; };

// Where rowStart holds the first bit of face s; the next word holds the end.
uint rowSlot(uint s) { return s + s / kRowsPerChunk; }

struct VisibilityRow {
  uvec2 chunk;   // its address
  uint at, end;  // bits
  uint next;     // the least id that may follow
};
VisibilityRow openRow(uvec2 chunk, uint at, uint end) { return VisibilityRow(chunk, at, end, 0u); }
bool hasEntry(VisibilityRow row) { return row.at < row.end; }

// 32 bits of x, then y, from bit `shift` < 32 on.
uint bitsFrom(uint x, uint y, uint shift) { return x >> shift | (shift == 0u ? 0u : y << (32u - shift)); }

// id | (count − 1) << 24. An entry takes 45 bits at most: one load, with no branch, brings them all.
uint nextEntry(inout VisibilityRow row, uint idCount) {
  uint carry;
  uint address = uaddCarry(row.chunk.x, 4u * (row.at >> 5), carry);
  uvec3 words = RowBits(uvec2(address, row.chunk.y + carry)).words;
  uint shift = row.at & 31u;
  RowCode step = decodeStep(bitsFrom(words.x, words.y, shift));
  uint after = shift + step.bits;
  RowCode count = decodeCount(after < 32u ? bitsFrom(words.x, words.y, after) : bitsFrom(words.y, words.z, after - 32u));
  row.at += step.bits + count.bits;
  uint id = entryId(row.next + step.value, idCount);
  row.next += step.value + 1u;
  return id | (count.value - 1u) << 24;
}

#endif
