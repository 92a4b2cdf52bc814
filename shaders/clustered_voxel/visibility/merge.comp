#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Counts what the rays of each row of a chunk hit: ids into a hash table of the row's own. A slot is an entry of shared/voxel.h, or
// kEmptySlot. Then the entries go to the table's front by ascending id, one more slot is empty, and their bits are added up.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "shared/visibility_row.h"
layout(set = 0, binding = 0, scalar) readonly buffer Hits { uint hits[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 2, scalar) buffer Table { uint table[]; };             // 2^tableBits a row, all empty
layout(set = 0, binding = 3, scalar) writeonly buffer Counts { uint counts[]; };  // bits a row; kRowsPerChunk + 1 words, 0 past the rows
layout(set = 0, binding = 4, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 5, scalar) buffer Weights { uint weights[]; };
layout(set = 0, binding = 6, scalar) buffer EntryCount { uint entryCount; };  // of all chunks
layout(push_constant, scalar) uniform Push {
  uint rowCount;
  uint rayCount;
  uint tableBits;
  uint clusterCount;
  uint firstFace;
  uint faceCount;
};
layout(constant_id = 0) const bool kCountSeen = true;  // weights=seen

// Integers, so that the order of rows does not matter. At the end of its range a weight stays, short of what several thousand lanes could add at once.
void addWeight(uint face, uint unit) {
  if (weights[face] < kMostWeight) atomicAdd(weights[face], unit);
}
#include "shared/dispatch.glsl"

uint idOf(uint hit) {
  if ((hit & kNearHit) != 0u) return clusterCount + (hit & kHitFace);
  return hit >= kMissHit ? kMissBase + (hit - kMissHit) : labels[hit & kHitFace];
}

// The row's bits.
uint sortEntries(uint base, uint slots, uint distinct) {
  uint found = 0u;
  for (uint slot = 0u; slot < slots && found < distinct; ++slot) {
    uint entry = table[base + slot];
    if (entry == kEmptySlot) continue;
    uint place = found++;
    for (; place > 0u && (table[base + place - 1u] & kEntryIdMask) > (entry & kEntryIdMask); --place)
      table[base + place] = table[base + place - 1u];
    table[base + place] = entry;
  }
  table[base + distinct] = kEmptySlot;
  uint next = 0u;
  uint bits = 0u;
  for (uint i = 0u; i < distinct; ++i) {
    uint id = rowId(table[base + i] & kEntryIdMask, clusterCount + faceCount);
    bits += rowEntryBits(id - next, (table[base + i] >> 24) + 1u);
    next = id + 1u;
  }
  return bits;
}

void main() {
  uint row = radivoxItemIndex();
  if (row > kRowsPerChunk) return;
  if (row >= rowCount) {
    counts[row] = 0u;
    return;
  }
  uint base = row << tableBits;
  uint mask = (1u << tableBits) - 1u;
  uint distinct = 0u;
  uint unit = uint(faces[firstFace + row].area * kAreaUnits + 0.5);
  if (!kCountSeen) weights[firstFace + row] = unit;
  for (uint ray = 0u; ray < rayCount; ++ray) {
    uint hit = hits[row * rayCount + ray];
    uint id = idOf(hit);
    // Close hits have the bit set, and so have misses.
    if (kCountSeen && (hit & kCloseHit) == 0u && unit > 0u) addWeight(hit & kHitFace, unit);
    uint slot = (id * 2654435769u) >> (32u - tableBits);
    uint entry = table[base + slot];
    while (entry != kEmptySlot && (entry & kEntryIdMask) != id) {
      slot = (slot + 1u) & mask;
      entry = table[base + slot];
    }
    distinct += entry == kEmptySlot ? 1u : 0u;
    table[base + slot] = entry == kEmptySlot ? id : entry + 0x01000000u;
  }
  counts[row] = sortEntries(base, mask + 1u, distinct);
  atomicAdd(entryCount, distinct);
}
