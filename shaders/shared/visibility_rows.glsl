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
  uvec2 chunk;  // its address
  uint at, end;  // bits
  uint next;     // the least id that may follow
};
VisibilityRow openRow(uvec2 chunk, uint at, uint end) { return VisibilityRow(chunk, at, end, 0u); }
bool hasEntry(VisibilityRow row) { return row.at < row.end; }

// id | (count − 1) << 24.
uint nextEntry(inout VisibilityRow row, uint idCount) {
  RowBits bits = RowBits(row.chunk);
  uint word = row.at >> 5;
  RowEntry entry = decodeRowEntry(rowWindow(bits.words[word], bits.words[word + 1u], bits.words[word + 2u], row.at));
  uint id = entryId(row.next + entry.step, idCount);
  row.next += entry.step + 1u;
  row.at += entry.bits;
  return id | (entry.count - 1u) << 24;
}

#endif
