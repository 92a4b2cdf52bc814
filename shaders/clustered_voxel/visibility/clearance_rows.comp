#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Clearance, first of three passes: distance along x to the nearest voxel with faces, or to the rim. A lane sweeps a row, both ways.
layout(local_size_x = 64) in;
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_FACE_MASK 3
layout(set = 0, binding = 4, scalar) buffer Output { uint rows[]; };
#include "shared/clearance.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

void main() {
  uint row = radivoxItemIndex();
  uvec2 rimmed = uvec2(row % (grid.size.y + 2u), row / (grid.size.y + 2u));
  if (rimmed.y >= grid.size.z + 2u) return;
  uint words = clearanceRowBytes(grid.size) / 4u;
  uint base = row * words;
  uint distance = 0u;
  for (uint w = 0u; w < words; ++w) {
    uint packed = 0u;
    for (uint b = 0u; b < 4u; ++b) {
      uint voxel = voxelIndex(ivec3(4u * w + b, rimmed) - 1);
      bool inGrid = isInside(ivec3(4u * w + b, rimmed) - 1);
      distance = !inGrid || (voxel != kNone && faceMask(voxel) != 0u) ? 0u : min(distance + 1u, kMaxClearance);
      packed |= distance << (8u * b);
    }
    rows[base + w] = packed;
  }
  distance = 0u;
  for (uint w = words; w-- > 0u;) {
    uint packed = rows[base + w];
    uint result = 0u;
    for (uint b = 4u; b-- > 0u;) {
      distance = min(distance + 1u, (packed >> (8u * b)) & 0xffu);
      result |= distance << (8u * b);
    }
    rows[base + w] = result;
  }
}
