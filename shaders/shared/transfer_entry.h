// Entries of the cluster matrix, a word each: column and form factor. Columns take as many bits as there are clusters for; the form factor
// takes the rest, 0 … 2^weightBits for 0 … 1 with both ends. The more clusters, the fewer rays share a row: as C + F fits 24 bits, a unit is
// less than the share of one ray of 64 however many clusters there are.
#ifndef RADIVOX_SHADERS_SHARED_TRANSFER_ENTRY_H
#define RADIVOX_SHADERS_SHARED_TRANSFER_ENTRY_H
#include "functions.h"
RADIVOX_SHARED_BEGIN

// At most 24: form factors are floats without rounding.
RADIVOX_FUNCTION uint transferWeightBits(uint clusterCount) {
  uint columnBits = 0u;
  while (clusterCount > 1u << columnBits) ++columnBits;
  return min(24u, 31u - columnBits);
}
RADIVOX_FUNCTION float transferUnit(uint weightBits) { return uintBitsToFloat((127u - weightBits) << 23); }

RADIVOX_FUNCTION uint packTransferEntry(uint column, uint units, uint weightBits) { return units | column << (weightBits + 1u); }
RADIVOX_FUNCTION uint transferColumn(uint entry, uint weightBits) { return entry >> (weightBits + 1u); }
RADIVOX_FUNCTION uint transferUnits(uint entry, uint weightBits) { return entry & ((2u << weightBits) - 1u); }

RADIVOX_SHARED_END
#endif
