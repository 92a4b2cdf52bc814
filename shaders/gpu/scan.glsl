// Shared by the scan shaders: a workgroup of 256 lanes sums 1024 items, four a lane. Sums are 64-bit, in pairs of words.
#ifndef RADIVOX_SHADERS_GPU_SCAN_GLSL
#define RADIVOX_SHADERS_GPU_SCAN_GLSL
#include "shared/dispatch.glsl"

layout(local_size_x = 256) in;

const uint kItemsPerLane = 4u;
const uint kLanes = 256u;
const uint kRows = 16u;  // lanes are summed in rows of 16: two workgroup barriers, no subgroup operations

shared uvec2 laneSums[kLanes];
shared uvec2 rowSums[kRows];

uvec2 addWide(uvec2 a, uvec2 b) {
  const uint low = a.x + b.x;
  return uvec2(low, a.y + b.y + uint(low < a.x));
}

/// Sum of `own` over the lanes before this one. All lanes of the workgroup must call it, once.
uvec2 sumLanesBefore(uvec2 own) {
  const uint lane = gl_LocalInvocationIndex;
  laneSums[lane] = own;
  barrier();
  if (lane < kRows) {
    uvec2 sum = uvec2(0u);
    for (uint i = lane * kRows; i < (lane + 1u) * kRows; ++i) {
      const uvec2 item = laneSums[i];
      laneSums[i] = sum;
      sum = addWide(sum, item);
    }
    rowSums[lane] = sum;
  }
  barrier();
  uvec2 before = laneSums[lane];
  for (uint row = 0u; row < lane / kRows; ++row) before = addWide(before, rowSums[row]);
  return before;
}

#endif
