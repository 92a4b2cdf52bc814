// Visibility rows as bits. Entries follow each other by ascending id; of each the distance to the id before and the count of rays, both in as
// many bits as they take: some 14 of the 32 of a word in Sponza, since rows see what lies together. Rows are read from the front, as all readers do.
//   5 bits: width w of the distance − 1, then its w − 1 bits below the highest; the count in Elias' gamma code, zeros first.
// Ids of misses come right after those of faces.
#ifndef RADIVOX_SHADERS_SHARED_VISIBILITY_ROW_H
#define RADIVOX_SHADERS_SHARED_VISIBILITY_ROW_H
#include "functions.h"
#include "voxel.h"
RADIVOX_SHARED_BEGIN

// Words past a chunk's last bit that a reader may load.
RADIVOX_CONST uint kRowPadding = 2u;

struct RowEntry {
  uint step;   // id − the id before − 1
  uint count;  // rays
  uint bits;
};

// idCount = C + F.
RADIVOX_FUNCTION uint rowId(uint id, uint idCount) { return id < kMissBase ? id : idCount + (id - kMissBase); }
RADIVOX_FUNCTION uint entryId(uint id, uint idCount) { return id < idCount ? id : kMissBase + (id - idCount); }

RADIVOX_FUNCTION uint bitWidth(uint x) {
  x |= x >> 1;
  x |= x >> 2;
  x |= x >> 4;
  x |= x >> 8;
  x |= x >> 16;
  return uint(bitCount(x));
}

RADIVOX_FUNCTION uint rowEntryBits(uint step, uint count) { return 3u + max(bitWidth(step), 1u) + 2u * bitWidth(count); }

// At most 45 bits, x first.
RADIVOX_FUNCTION uvec2 encodeRowEntry(uint step, uint count) {
  uint width = bitWidth(step);
  uint below = max(width, 1u) - 1u;
  uint zeros = bitWidth(count) - 1u;
  uint gamma = (1u << zeros) | (count & ((1u << zeros) - 1u)) << (zeros + 1u);
  uint low = width | (step & ((1u << below) - 1u)) << 5u;
  uint at = 5u + below;
  return uvec2(low | gamma << at, gamma >> (32u - at));
}

// From 64 bits that begin with the entry.
RADIVOX_FUNCTION RowEntry decodeRowEntry(uvec2 bits) {
  RowEntry entry;
  uint width = bits.x & 31u;
  uint below = max(width, 1u) - 1u;
  entry.step = width == 0u ? 0u : 1u << below | ((bits.x >> 5u) & ((1u << below) - 1u));
  uint at = 5u + below;
  uint gamma = bits.x >> at | bits.y << (32u - at);
  uint zeros = uint(bitCount((gamma & (~gamma + 1u)) - 1u));
  entry.count = 1u << zeros | ((gamma >> (zeros + 1u)) & ((1u << zeros) - 1u));
  entry.bits = at + 2u * zeros + 1u;
  return entry;
}

// Bits [at, at + 64) of three words that begin with the one that holds `at`.
RADIVOX_FUNCTION uvec2 rowWindow(uint a, uint b, uint c, uint at) {
  uint shift = at & 31u;
  return shift == 0u ? uvec2(a, b) : uvec2(a >> shift | b << (32u - shift), b >> shift | c << (32u - shift));
}

#ifdef __cplusplus
/// visit(id, count) for each entry of the row at bits [at, end) of a chunk, padding included.
template <class Visit>
void forEachRowEntry(const uint* words, uint at, uint end, uint idCount, Visit&& visit) {
  for (uint next = 0; at < end;) {
    const uint* w = words + at / 32;
    const RowEntry entry = decodeRowEntry(rowWindow(w[0], w[1], w[2], at));
    visit(entryId(next + entry.step, idCount), entry.count);
    next += entry.step + 1;
    at += entry.bits;
  }
}
#endif

RADIVOX_SHARED_END
#endif
