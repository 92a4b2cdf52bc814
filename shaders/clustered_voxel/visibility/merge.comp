#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Counts what the rays of each row of a chunk hit: ids into a hash table of the row's own. A slot is an entry of shared/voxel.h, or
// kEmptySlot. Then the entries go to the table's front by ascending id, one more slot is empty, and their bits are added up. The hits of at most
// sixteen rays are sorted as they are: no table is searched.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "shared/visibility_row.h"
layout(set = 0, binding = 0) uniform usamplerBuffer hitTexels;
layout(set = 0, binding = 1) uniform usamplerBuffer labelTexels;
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
layout(constant_id = 1) const bool kFewRays = false;   // sixteen at most

// Integers, so that the order of rows does not matter. At the end of its range a weight stays, short of what several thousand lanes could add at once.
void addWeight(uint face, uint unit) {
  if (weights[face] < kMostWeight) atomicAdd(weights[face], unit);
}
#include "clustered_voxel/visibility/sort_sixteen.glsl"
#include "shared/dispatch.glsl"

uint idOf(uint hit) {
  if ((hit & kNearHit) != 0u) return clusterCount + (hit & kHitFace);
  return hit >= kMissHit ? kMissBase + (hit - kMissHit) : texelFetch(labelTexels, int(hit & kHitFace)).x;
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

uint hitAt(uint row, uint ray) { return texelFetch(hitTexels, int(row * rayCount + ray)).x; }

// Close hits have the bit set, and so have misses.
void countSeen(uint hit, uint unit) {
  if (kCountSeen && (hit & kCloseHit) == 0u && unit > 0u) addWeight(hit & kHitFace, unit);
}

// The row's bits; its entries are written to the table's front.
uint mergeFew(uint row, uint base, uint unit, out uint distinct) {
  uint ids[16];
  [[unroll]] for (uint ray = 0u; ray < 16u; ++ray) {
    ids[ray] = kEmptySlot;
    if (ray < rayCount) {
      uint hit = hitAt(row, ray);
      countSeen(hit, unit);
      ids[ray] = idOf(hit);
    }
  }
  sortSixteen(ids);
  distinct = 0u;
  uint next = 0u;
  uint bits = 0u;
  uint count = 0u;
  [[unroll]] for (uint i = 0u; i < 16u; ++i) {
    ++count;
    bool last = i == 15u || ids[i] != ids[i + 1u];
    if (last && ids[i] != kEmptySlot) {
      table[base + distinct++] = ids[i] | (count - 1u) << 24;
      uint id = rowId(ids[i], clusterCount + faceCount);
      bits += rowEntryBits(id - next, count);
      next = id + 1u;
    }
    count = last ? 0u : count;
  }
  table[base + distinct] = kEmptySlot;
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
  if (kFewRays) {
    counts[row] = mergeFew(row, base, unit, distinct);
    atomicAdd(entryCount, distinct);
    return;
  }
  for (uint ray = 0u; ray < rayCount; ++ray) {
    uint hit = hitAt(row, ray);
    uint id = idOf(hit);
    countSeen(hit, unit);
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
