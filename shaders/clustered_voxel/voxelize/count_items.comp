#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Compute way, first step: how many items each triangle is.
#include "clustered_voxel/voxelize/triangle.glsl"
#include "clustered_voxel/voxelize/items.glsl"
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 3, scalar) writeonly buffer ItemCounts { uint itemCounts[]; };

void main() {
  uint triangle = radivoxItemIndex();
  if (triangle >= triangleCount) return;
  itemCounts[triangle] = itemCountOf(loadTriangle(triangle));
}
