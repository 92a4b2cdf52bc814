// Shared by the scan shaders: a workgroup sums 1024 items. On GPUs 256 lanes take four each; a CPU, which runs the lanes of a
// workgroup one vector after the other and stops at every workgroup barrier, is faster with few lanes of many items.
#ifndef RADIVOX_SHADERS_GPU_SCAN_GLSL
#define RADIVOX_SHADERS_GPU_SCAN_GLSL
#include "shared/dispatch.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 1) const uint kLanes = 256u;

const uint kBlock = 1024u;
const uint kItemsPerLane = kBlock / kLanes;
const uint kRow = 16u;  // lanes are summed in rows of 16: two workgroup barriers, no subgroup operations
const uint kRows = (kLanes + kRow - 1u) / kRow;

shared uvec2 laneSums[kLanes];
shared uvec2 rowSums[kRows];
shared uint laneSumsNarrow[kLanes];
shared uint rowSumsNarrow[kRows];

uvec2 addWide(uvec2 a, uvec2 b) {
  const uint low = a.x + b.x;
  return uvec2(low, a.y + b.y + uint(low < a.x));
}

/// Sum of `own` over the lanes before this one. All lanes of the workgroup must call it, once.
uvec2 sumLanesBeforeWide(uvec2 own) {
  const uint lane = gl_LocalInvocationIndex;
  laneSums[lane] = own;
  barrier();
  if (lane < kRows) {
    uvec2 sum = uvec2(0u);
    for (uint i = lane * kRow; i < min((lane + 1u) * kRow, kLanes); ++i) {
      const uvec2 item = laneSums[i];
      laneSums[i] = sum;
      sum = addWide(sum, item);
    }
    rowSums[lane] = sum;
  }
  barrier();
  uvec2 before = laneSums[lane];
  for (uint row = 0u; row < lane / kRow; ++row) before = addWide(before, rowSums[row]);
  return before;
}

/// Likewise, modulo 2^32.
uint sumLanesBefore(uint own) {
  const uint lane = gl_LocalInvocationIndex;
  laneSumsNarrow[lane] = own;
  barrier();
  if (lane < kRows) {
    uint sum = 0u;
    for (uint i = lane * kRow; i < min((lane + 1u) * kRow, kLanes); ++i) {
      const uint item = laneSumsNarrow[i];
      laneSumsNarrow[i] = sum;
      sum += item;
    }
    rowSumsNarrow[lane] = sum;
  }
  barrier();
  uint before = laneSumsNarrow[lane];
  for (uint row = 0u; row < lane / kRow; ++row) before += rowSumsNarrow[row];
  return before;
}

#endif
