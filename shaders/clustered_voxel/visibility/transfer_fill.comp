#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Rows of the cluster matrix: F_cc' = Σ_s w_s m_sc' / Σ_s w_s M_s, and the misses. Weights become integers relative to the cluster's
// largest (31 bits), so the sums are exact and the same for any order. Form factors are rounded to their units (shared/transfer_entry.h) in
// running sums over the columns: no entry is off by a unit, and every row with its misses sums to one exactly.
#include "clustered_voxel/visibility/transfer_columns.glsl"
#include "shared/fixed_point.glsl"
#include "shared/transfer_entry.h"
layout(set = 0, binding = 5, scalar) readonly buffer Starts { uint starts[]; };
layout(set = 0, binding = 6, scalar) readonly buffer FaceAreas { Face faces[]; };
layout(set = 0, binding = 7, scalar) writeonly buffer Sky { float sky[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Weights { uint weights[]; };
layout(constant_id = 2) const bool kSky = false;       // somebody reads it
layout(constant_id = 0) const bool kWeighted = false;  // weights are there

// What a face counts for in its cluster's row: how much of it others see; its area where that is not given, or nobody sees any face of the cluster.
float weightOf(uint face, bool byArea) { return byArea ? faces[face].area : float(weights[face]); }

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer MatrixEntry { uint value; };
// Entries are found from the row's address: their number times four does not fit 32 bits in large scenes.
MatrixEntry entryAt(uint index) {
  uint high, low;
  umulExtended(index, 4u, high, low);
  uint carry;
  uint addressLow = uaddCarry(push.matrix.x, low, carry);
  return MatrixEntry(uvec2(addressLow, push.matrix.y + high + carry));
}

// Columns whose sums are in shared memory at a time: nearly always the whole row.
const uint kBatch = 1024u;
shared uint sumLow[kBatch], sumHigh[kBatch];
shared uint laneSums[kLanes];
shared uint laneLow[kLanes], laneHigh[kLanes];
shared uint greatestWeight;
shared uint totalLow, totalHigh, skyLow, skyHigh;

uvec2 timesCount(uint unit, uint count) {
  uint high, low;
  umulExtended(unit, count, high, low);
  return uvec2(low, high);
}

uint weightUnits(float weight, float greatest) { return uint(weight / greatest * 2147483648.0); }

// part · 2^weightBits / whole to the nearest integer; part ≤ whole. Only 31 bits of both count: what is left of the rounding is the same for
// every call with this whole, so the result never falls as part grows.
uint unitsOf(uvec2 part, uvec2 whole) {
  if (whole == uvec2(0u)) return 0u;
  int top = whole.y != 0u ? 32 + findMSB(whole.y) : findMSB(whole.x);
  int drop = max(top - 30, 0);
  uint divisor = drop >= 32 ? whole.y >> (drop - 32) : drop == 0 ? whole.x : (whole.y << (32 - drop)) | (whole.x >> drop);
  uint rest = drop >= 32 ? part.y >> (drop - 32) : drop == 0 ? part.x : (part.y << (32 - drop)) | (part.x >> drop);
  uint units = rest / divisor;
  rest -= units * divisor;
  [[unroll]] for (uint i = 0u; i < 24u; ++i) {
    bool counts = i < push.weightBits;
    uint twice = counts ? rest << 1 : rest;
    bool above = counts && twice >= divisor;
    rest = above ? twice - divisor : twice;
    units = counts ? units << 1 | (above ? 1u : 0u) : units;
  }
  return units + (2u * rest >= divisor ? 1u : 0u);
}

// The cluster's largest weight; all lanes.
float greatestOf(uvec2 range, bool byArea) {
  uint lane = gl_LocalInvocationID.x;
  if (lane == 0u) greatestWeight = 0u;
  barrier();
  uint greatest = 0u;
  for (uint i = range.x + lane; i < range.y; i += kLanes) greatest = max(greatest, floatBitsToUint(weightOf(memberAt(i), byArea)));
  if (greatest > 0u) atomicMax(greatestWeight, greatest);  // weights are positive: their bits are ordered as they are
  barrier();
  return uintBitsToFloat(greatestWeight);
}

// The row of one cluster; all lanes.
void fillRow(uint c) {
  uint lane = gl_LocalInvocationID.x;
  uvec2 range = membersOf(c);
  if (lane == 0u) totalLow = totalHigh = skyLow = skyHigh = 0u;
  barrier();
  bool byArea = !kWeighted;
  float greatest = greatestOf(range, byArea);
  if (greatest == 0.0) {
    byArea = true;
    barrier();
    greatest = greatestOf(range, byArea);
  }

  uvec2 total = uvec2(0u);
  uvec2 missed = uvec2(0u);
  uvec2 passed = uvec2(0u);  // of the row's sum, by columns that are done
  uint row = starts[c];
  for (uint window = 0u; window < push.clusterCount; window += kWindow) {
    findColumns(range, window);
    // Columns before each word that has any: each lane's are added up, then those of the lanes before.
    laneSums[lane] = countOwnColumns();
    barrier();
    uint before = 0u;
    uint windowColumns = 0u;
    for (uint i = 0u; i < kLanes; ++i) {
      if (i < lane) before += laneSums[i];
      windowColumns += laneSums[i];
    }
    for (uint w = kOwnSums * lane; w < kOwnSums * (lane + 1u); ++w) {
      for (uint left = wordBits[w]; left != 0u; left &= left - 1u) {
        uint word = 32u * w + uint(findLSB(left));
        columnBits[word].y = before;
        before += uint(bitCount(columnBits[word].x));
      }
    }

    // The first batch of all adds up the whole, columns or none.
    for (uint firstRank = 0u; firstRank < windowColumns || (window == 0u && firstRank == 0u); firstRank += kBatch) {
      bool addsUp = window == 0u && firstRank == 0u;
      uint count = min(kBatch, windowColumns - firstRank);
      for (uint i = lane; i < count; i += kLanes) sumLow[i] = sumHigh[i] = 0u;
      barrier();
      for (uint i = range.x + lane; i < range.y; i += kLanes) {
        uint s = memberAt(i);
        uint unit = weightUnits(weightOf(s, byArea), greatest);
        VisibilityRow seen = rowOf(s);
        while (hasEntry(seen)) {
          uint entry = nextEntry(seen, push.clusterCount + push.faceCount);
          uvec2 share = timesCount(unit, countOf(entry));
          uint column = columnOf(entry);
          if (addsUp) {
            total = fixedAdd(total, share);
            if (column == kMissBase) missed = fixedAdd(missed, share);
          }
          column -= window;
          if (column < kWindow && column + window < push.clusterCount) {
            uvec2 word = columnBits[column >> 5];
            uint rank = word.y + uint(bitCount(word.x & ((1u << (column & 31u)) - 1u))) - firstRank;
            if (rank < kBatch) radivoxFixedAtomicAdd(sumLow[rank], sumHigh[rank], share);
          }
        }
      }
      if (addsUp) {
        if (total != uvec2(0u)) radivoxFixedAtomicAdd(totalLow, totalHigh, total);
        if (missed != uvec2(0u)) radivoxFixedAtomicAdd(skyLow, skyHigh, missed);
      }
      barrier();

      // Lanes take runs of columns: what was passed before each, in units, is what it begins with.
      uvec2 whole = uvec2(totalLow, totalHigh);
      uint columnRun = (count + kLanes - 1u) / kLanes;
      uint firstColumn = min(lane * columnRun, count);
      uint endColumn = min(firstColumn + columnRun, count);
      uvec2 runSum = uvec2(0u);
      for (uint i = firstColumn; i < endColumn; ++i) runSum = fixedAdd(runSum, uvec2(sumLow[i], sumHigh[i]));
      laneLow[lane] = runSum.x;
      laneHigh[lane] = runSum.y;
      barrier();
      uvec2 upTo = passed;
      for (uint i = 0u; i * columnRun < count; ++i) {
        if (i < lane) upTo = fixedAdd(upTo, uvec2(laneLow[i], laneHigh[i]));
        passed = fixedAdd(passed, uvec2(laneLow[i], laneHigh[i]));
      }
      if (firstColumn < endColumn) {
        uint unitsBefore = unitsOf(upTo, whole);
        for (uint i = firstColumn; i < endColumn; ++i) {
          upTo = fixedAdd(upTo, uvec2(sumLow[i], sumHigh[i]));
          uint units = unitsOf(upTo, whole);
          sumLow[i] = units - unitsBefore;
          unitsBefore = units;
        }
      }
      barrier();
      for (uint w = kOwnSums * lane; w < kOwnSums * (lane + 1u); ++w) {
        for (uint left = wordBits[w]; left != 0u; left &= left - 1u) {
          uint word = 32u * w + uint(findLSB(left));
          uint rank = columnBits[word].y - firstRank;
          for (uint bits = columnBits[word].x; bits != 0u; bits &= bits - 1u) {
            uint column = window + word * 32u + uint(findLSB(bits));
            if (rank < count) entryAt(row + firstRank + rank).value = packTransferEntry(column, sumLow[rank], push.weightBits);
            rank += 1u;
          }
        }
      }
      barrier();
    }
    row += windowColumns;
    forgetColumns();
  }
  // What is lost on backs lies between the columns and the misses.
  if (kSky && lane == 0u) {
    uvec2 whole = uvec2(totalLow, totalHigh);
    uint kept = unitsOf(fixedAdd(whole, fixedNegate(uvec2(skyLow, skyHigh))), whole);
    sky[c] = 1.0 - float(kept) * transferUnit(push.weightBits);
  }
}

void main() {
  uint c = radivoxGroupIndex();
  if (c >= push.clusterCount) return;  // the whole group
  clearColumns();
  fillRow(c);
}
