#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Clearance, last pass: a lane grows the box of a voxel on all sides in turn, by 1, 2, 4, 8, 16 voxels as long as they are free, then by 8, 4, 2, 1 where
// they were not. Along a floor it grows long: there a ray that leaves it in a step would take a voxel at a time from the cube around it.
layout(local_size_x = 64) in;
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
layout(set = 0, binding = 3) uniform usamplerBuffer sums;  // clearance_sums.comp
layout(set = 0, binding = 4, scalar) writeonly buffer Output { uint clearance[]; };
#include "shared/clearance.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

uint sumTo(uint x, uint y, uint z) { return texelFetch(sums, int(clearanceSumIndex(uvec3(x, y, z), grid.size))).x; }

// What stands in the way in a box of rimmed coordinates, ends included; none of them 0.
uint countIn(uvec3 low, uvec3 high) {
  uvec3 below = low - 1u;
  return (sumTo(high.x, high.y, high.z) - sumTo(below.x, high.y, high.z)) - (sumTo(high.x, below.y, high.z) - sumTo(below.x, below.y, high.z)) -
         (sumTo(high.x, high.y, below.z) - sumTo(below.x, high.y, below.z)) + (sumTo(high.x, below.y, below.z) - sumTo(below.x, below.y, below.z));
}

void main() {
  uint item = radivoxItemIndex();
  uvec3 size = grid.size + 2u;
  uvec3 at = uvec3(item % size.x, (item / size.x) % size.y, item / (size.x * size.y));
  if (at.z >= size.z) return;
  uint place = clearanceIndex(at, grid.size);
  bool isRim = any(equal(at, uvec3(0u))) || any(equal(at, size - 1u));
  if (isRim || countIn(at, at) != 0u) {
    clearance[place] = isRim ? 0u : voxelIndex(ivec3(at) - 1) + 1u;
    return;
  }
  uvec3 low = at, high = at;
  uint word = kClearanceOpen;
  for (uint turn = 0u; turn < 9u * kFaceCount; ++turn) {
    uint f = turn % kFaceCount, round_ = turn / kFaceCount;
    uint step = 1u << (round_ < 5u ? round_ : 8u - round_);
    uvec3 along = uvec3(f >> 1 == 0u, f >> 1 == 1u, f >> 1 == 2u);
    bool up = (f & 1u) == 0u;
    uvec3 from = up ? low + along * (high + 1u - low) : low - min(low, along * step);
    uvec3 to = up ? high + along * step : high - along * (high + 1u - low);
    uint shift = kClearanceBits * f;
    bool fits = all(greaterThan(from, uvec3(0u))) && all(lessThan(to, size - 1u)) && ((word >> shift) & kMostClearance) + step <= kMostClearance;
    if (fits && countIn(max(from, uvec3(1u)), min(to, size - 1u)) == 0u) {
      low = min(low, from);
      high = max(high, to);
      word += step << shift;
    }
  }
  clearance[place] = word;
}
