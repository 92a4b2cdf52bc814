#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Rows of the cluster matrix: F_cc' = Σ_s w_s m_sc' / Σ_s w_s M_s, and the misses. Weights become integers relative to the cluster's
// largest (31 bits), so the sums are exact and the same for any order, and every row with its misses sums to one but for the last
// rounding of each entry. Until a row is done its entries hold the two words of their sums.
#include "clustered_voxel/visibility/transfer_columns.glsl"
#include "shared/fixed_point.glsl"
layout(set = 0, binding = 5, scalar) readonly buffer Starts { uint starts[]; };
layout(set = 0, binding = 6, scalar) readonly buffer FaceAreas { Face faces[]; };
layout(set = 0, binding = 7, scalar) writeonly buffer Sky { float sky[]; };
layout(constant_id = 0) const bool kWeighted = false;
#define RADIVOX_BIND_WEIGHTS 8
#include "clustered_voxel/weights.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer MatrixEntry { uvec2 value; };
// Entries are found from the row's address: their number times eight does not fit 32 bits in large scenes.
MatrixEntry entryAt(uint index) {
  uint high, low;
  umulExtended(index, 8u, high, low);
  uint carry;
  uint addressLow = uaddCarry(push.matrix.x, low, carry);
  return MatrixEntry(uvec2(addressLow, push.matrix.y + high + carry));
}

shared uint columnsBefore[kWords];
shared uint laneSums[kLanes];
shared uint greatestWeight;
shared uint totalLow, totalHigh, skyLow, skyHigh;

uvec2 timesCount(uint unit, uint count) {
  uint high, low;
  umulExtended(unit, count, high, low);
  return uvec2(low, high);
}

uint weightUnits(float weight, float greatest) { return uint(weight / greatest * 2147483648.0); }

// The cluster's largest weight; all lanes.
float greatestOf(Cluster cluster, bool byArea) {
  uint lane = gl_LocalInvocationID.x;
  if (lane == 0u) greatestWeight = 0u;
  barrier();
  uint greatest = 0u;
  for (uint i = lane; i < cluster.faceCount; i += kLanes)
    greatest = max(greatest, floatBitsToUint(weightOf(members[cluster.firstMember + i], byArea)));
  if (greatest > 0u) atomicMax(greatestWeight, greatest);  // weights are positive: their bits are ordered as they are
  barrier();
  return uintBitsToFloat(greatestWeight);
}

void main() {
  uint c = radivoxGroupIndex();
  if (c >= push.clusterCount) return;  // the whole group
  uint lane = gl_LocalInvocationID.x;
  Cluster cluster = clusters[c];
  if (lane == 0u) {
    totalLow = totalHigh = skyLow = skyHigh = 0u;
  }
  barrier();
  bool byArea = !kWeighted;
  float greatest = greatestOf(cluster, byArea);
  if (greatest == 0.0) {
    byArea = true;
    barrier();
    greatest = greatestOf(cluster, byArea);
  }

  uvec2 total = uvec2(0u);
  uvec2 missed = uvec2(0u);
  uint row = starts[c];
  for (uint window = 0u; window < push.clusterCount; window += kWindow) {
    findColumns(cluster, window);
    // Columns before each word: lanes take runs of words, then the runs are added up.
    uint words = windowWords(window);
    uint run = (words + kLanes - 1u) / kLanes;
    uint begin = min(lane * run, words);
    uint end = min(begin + run, words);
    uint sum = 0u;
    for (uint i = begin; i < end; ++i) {
      columnsBefore[i] = sum;
      sum += uint(bitCount(columnBits[i]));
    }
    laneSums[lane] = sum;
    barrier();
    uint before = 0u;
    uint windowColumns = 0u;
    for (uint i = 0u; i < kLanes; ++i) {
      if (i < lane) before += laneSums[i];
      windowColumns += laneSums[i];
    }
    for (uint i = begin; i < end; ++i) columnsBefore[i] += before;
    for (uint i = lane; i < windowColumns; i += kLanes) entryAt(row + i).value = uvec2(0u);
    memoryBarrierBuffer();
    barrier();

    for (uint i = lane; i < cluster.faceCount; i += kLanes) {
      uint s = members[cluster.firstMember + i];
      uint unit = weightUnits(weightOf(s, byArea), greatest);
      uint slot = rowSlot(s);
      uint rowEnd = rowStart[slot + 1u];
      Entries entries = chunkEntries(chunkTable[s / kRowsPerChunk]);
      for (uint e = rowStart[slot]; e < rowEnd; ++e) {
        uint entry = entries.words[e];
        uvec2 share = timesCount(unit, countOf(entry));
        uint column = columnOf(entry);
        if (window == 0u) {
          total = fixedAdd(total, share);
          if (column == kMissBase) missed = fixedAdd(missed, share);
        }
        column -= window;
        if (column < kWindow && column + window < push.clusterCount) {
          uint word = column >> 5;
          uint rank = columnsBefore[word] + uint(bitCount(columnBits[word] & ((1u << (column & 31u)) - 1u)));
          MatrixEntry target = entryAt(row + rank);
          radivoxFixedAtomicAdd(target.value.x, target.value.y, share);
        }
      }
    }
    if (window == 0u) {
      radivoxFixedAtomicAdd(totalLow, totalHigh, total);
      radivoxFixedAtomicAdd(skyLow, skyHigh, missed);
    }
    memoryBarrierBuffer();
    barrier();

    float scale = fixedToFloatBits(uvec2(totalLow, totalHigh), 0);
    if (window == 0u && lane == 0u) sky[c] = scale > 0.0 ? fixedToFloatBits(uvec2(skyLow, skyHigh), 0) / scale : 1.0;
    for (uint i = lane; i < words; i += kLanes) {
      uint bits = columnBits[i];
      uint rank = columnsBefore[i];
      while (bits != 0u) {
        uint bit = uint(findLSB(bits));
        bits &= bits - 1u;
        MatrixEntry target = entryAt(row + rank);
        float weight = fixedToFloatBits(target.value, 0) / scale;
        target.value = uvec2(window + i * 32u + bit, floatBitsToUint(weight));
        rank += 1u;
      }
    }
    row += windowColumns;
    barrier();
  }
}
