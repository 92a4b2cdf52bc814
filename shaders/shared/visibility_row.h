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

// A number and the bits that it took.
struct RowCode {
  uint value;
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

// From 32 bits that begin with it: id − the id before − 1.
RADIVOX_FUNCTION RowCode decodeStep(uint bits) {
  uint width = bits & 31u;
  uint below = max(width, 1u) - 1u;
  RowCode code;
  code.value = width == 0u ? 0u : 1u << below | ((bits >> 5u) & ((1u << below) - 1u));
  code.bits = 5u + below;
  return code;
}
RADIVOX_FUNCTION RowCode decodeCount(uint bits) {
  uint zeros = uint(bitCount((bits & (~bits + 1u)) - 1u));
  RowCode code;
  code.value = 1u << zeros | ((bits >> (zeros + 1u)) & ((1u << zeros) - 1u));
  code.bits = 2u * zeros + 1u;
  return code;
}

#ifdef __cplusplus
/// visit(id, count) for each entry of the row at bits [at, end) of a chunk, padding included.
template <class Visit>
void forEachRowEntry(const uint* words, uint at, uint end, uint idCount, Visit&& visit) {
  const auto bits = [&] { return at % 32 == 0 ? words[at / 32] : words[at / 32] >> at % 32 | words[at / 32 + 1] << (32 - at % 32); };
  for (uint next = 0; at < end;) {
    const RowCode step = decodeStep(bits());
    at += step.bits;
    const RowCode count = decodeCount(bits());
    at += count.bits;
    visit(entryId(next + step.value, idCount), count.value);
    next += step.value + 1;
  }
}
#endif

RADIVOX_SHARED_END
#endif
