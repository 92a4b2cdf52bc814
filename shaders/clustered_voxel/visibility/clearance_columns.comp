#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Clearance, second and third pass (axis 1, then 2): from distances within rows to distances in the plane, then in space:
// D(y) = min over r of max(|r|, D'(y + r)). A lane makes one word, four voxels along x.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kAxis = 1;
layout(set = 0, binding = 0, scalar) readonly buffer Input { uint before[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Output { uint after[]; };
#define RADIVOX_BIND_GRID 2
#include "shared/clearance.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

uvec4 unpackBytes(uint word) { return (uvec4(word) >> uvec4(0u, 8u, 16u, 24u)) & 0xffu; }

void main() {
  uint item = radivoxItemIndex();
  uint words = clearanceRowBytes(grid.size) / 4u;
  uint row = item / words;
  uvec2 rimmed = uvec2(row % (grid.size.y + 2u), row / (grid.size.y + 2u));
  if (rimmed.y >= grid.size.z + 2u) return;
  uint at = kAxis == 1u ? rimmed.x : rimmed.y;
  uint last = kAxis == 1u ? grid.size.y + 1u : grid.size.z + 1u;
  uint stride = kAxis == 1u ? words : words * (grid.size.y + 2u);
  uvec4 best = unpackBytes(before[item]);
  // The rim bounds every distance, so item ± r · stride stays in the buffer.
  best = min(best, uvec4(min(at, last - at)));
  for (uint r = 1u; any(lessThan(uvec4(r), best)); ++r) {
    uvec4 low = max(unpackBytes(before[item - r * stride]), uvec4(r));
    uvec4 high = max(unpackBytes(before[item + r * stride]), uvec4(r));
    best = min(best, min(low, high));
  }
  after[item] = best.x | best.y << 8 | best.z << 16 | best.w << 24;
}
