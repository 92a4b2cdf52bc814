// One group a cluster: which clusters its faces' rows name. Columns are looked at in windows of 65536, each a bit set in shared
// memory, so that they come out ascending and without a table; scenes of more clusters read their rows again for every window. Which words of the set
// have bits is kept in a set of its own: a cluster's work follows what its rows name, not how many clusters there are.
#ifndef RADIVOX_TRANSFER_COLUMNS_GLSL
#define RADIVOX_TRANSFER_COLUMNS_GLSL
#include "shared/cluster_member.h"
#include "shared/dispatch.glsl"
#include "shared/visibility_rows.glsl"

layout(local_size_x_id = 1) in;
layout(push_constant, scalar) uniform Push {
  uint clusterCount;
  uint faceCount;
  uvec2 matrix;  // device address of the entries (fill only)
  uint weightBits;
} push;
// Texels: see shared/voxel_lookup.glsl.
layout(set = 0, binding = 0) uniform usamplerBuffer rowStart;
layout(set = 0, binding = 1, scalar) readonly buffer ChunkTable { uvec2 chunkTable[]; };
layout(set = 0, binding = 2) uniform usamplerBuffer labels;
layout(set = 0, binding = 3, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 4) uniform usamplerBuffer members;
// Where the members of a cluster begin and end.
uvec2 membersOf(uint c) { return uvec2(clusters[c].firstMember, clusters[c + 1u].firstMember); }
uint memberAt(uint i) { return memberFace(texelFetch(members, int(i)).x); }

layout(constant_id = 1) const uint kLanes = 64u;  // 64 or a part of it
const uint kWindow = 65536u;
const uint kWords = kWindow / 32u;
const uint kSums = kWords / 32u;
const uint kOwnSums = kSums / kLanes;  // words of wordBits that a lane takes, side by side
shared uvec2 columnBits[kWords];  // x: 32 columns, y: how many are in the words before (fill only)
shared uint wordBits[kSums];  // of the words of columnBits that are not 0

// Column of an entry: the cluster, or that of the near face; kMissBase for rays that left the scene, kAbsorbed for those lost on backs.
uint columnOf(uint entry) {
  uint id = entry & kEntryIdMask;
  if (id < push.clusterCount) return id;
  if (id < push.clusterCount + push.faceCount) return texelFetch(labels, int(id - push.clusterCount)).x;
  return id < kAbsorbed ? kMissBase : kAbsorbed;
}
uint countOf(uint entry) { return (entry >> 24) + 1u; }

VisibilityRow rowOf(uint s) {
  uint slot = rowSlot(s);
  return openRow(chunkTable[s / kRowsPerChunk], texelFetch(rowStart, int(slot)).x, texelFetch(rowStart, int(slot + 1u)).x);
}

// All lanes, once; ends with a barrier.
void clearColumns() {
  uint lane = gl_LocalInvocationID.x;
  for (uint i = lane; i < min(kWords, (push.clusterCount + 31u) / 32u); i += kLanes) columnBits[i].x = 0u;
  for (uint i = lane; i < kSums; i += kLanes) wordBits[i] = 0u;
  barrier();
}

// All lanes; ends with a barrier.
void forgetColumns() {
  uint lane = gl_LocalInvocationID.x;
  for (uint w = kOwnSums * lane; w < kOwnSums * (lane + 1u); ++w) {
    for (uint left = wordBits[w]; left != 0u; left &= left - 1u) columnBits[32u * w + uint(findLSB(left))].x = 0u;
    wordBits[w] = 0u;
  }
  barrier();
}

// How many columns the lane has in the set.
uint countOwnColumns() {
  uint lane = gl_LocalInvocationID.x;
  uint found = 0u;
  for (uint w = kOwnSums * lane; w < kOwnSums * (lane + 1u); ++w) {
    for (uint left = wordBits[w]; left != 0u; left &= left - 1u) found += uint(bitCount(columnBits[32u * w + uint(findLSB(left))].x));
  }
  return found;
}

// All lanes; ends with a barrier. The set is empty before.
void findColumns(uvec2 range, uint window) {
  uint lane = gl_LocalInvocationID.x;
  for (uint i = range.x + lane; i < range.y; i += kLanes) {
    uint s = memberAt(i);
    VisibilityRow row = rowOf(s);
    while (hasEntry(row)) {
      uint column = columnOf(nextEntry(row, push.clusterCount + push.faceCount)) - window;  // wraps for columns before the window
      if (column >= kWindow || column + window >= push.clusterCount) continue;
      uint word = column >> 5;
      if (atomicOr(columnBits[word].x, 1u << (column & 31u)) == 0u) atomicOr(wordBits[word >> 5], 1u << (word & 31u));
    }
  }
  barrier();
}

#endif
