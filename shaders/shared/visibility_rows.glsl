// Reading visibility rows: chunks of bits by device address (layout: shaders/shared/visibility_row.h).
#ifndef RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#define RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/visibility_row.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RowBits { uint words[]; };

// Where rowStart holds the first bit of face s; the next word holds the end.
uint rowSlot(uint s) { return s + s / kRowsPerChunk; }

struct VisibilityRow {
  uvec2 chunk;   // its address
  uint at, end;  // bits
  uint next;     // the least id that may follow
  uvec2 window;  // bits from `at` on, x first
  uint held;     // of these: so many
};
VisibilityRow openRow(uvec2 chunk, uint at, uint end) {
  uint shift = at & 31u;
  return VisibilityRow(chunk, at, end, 0u, uvec2(at < end ? RowBits(chunk).words[at >> 5] >> shift : 0u, 0u), 32u - shift);
}
bool hasEntry(VisibilityRow row) { return row.at < row.end; }

// Words are loaded once, as they come: a number takes 28 bits at most.
uint rowBits(inout VisibilityRow row) {
  if (row.held < 32u) {
    uint word = RowBits(row.chunk).words[(row.at + row.held) >> 5];
    row.window = row.held == 0u ? uvec2(word, 0u) : uvec2(row.window.x | word << row.held, word >> (32u - row.held));
    row.held += 32u;
  }
  return row.window.x;
}
void skipBits(inout VisibilityRow row, uint bits) {
  row.window = uvec2(row.window.x >> bits | row.window.y << (32u - bits), row.window.y >> bits);
  row.held -= bits;
  row.at += bits;
}

// id | (count − 1) << 24.
uint nextEntry(inout VisibilityRow row, uint idCount) {
  RowCode step = decodeStep(rowBits(row));
  skipBits(row, step.bits);
  RowCode count = decodeCount(rowBits(row));
  skipBits(row, count.bits);
  uint id = entryId(row.next + step.value, idCount);
  row.next += step.value + 1u;
  return id | (count.value - 1u) << 24;
}

#endif
