#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests/gpu: counts how often each item is visited, by dispatchItems or by indirect arguments over a list of items.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kThroughList = false;
layout(set = 0, binding = 0, scalar) buffer Visits { uint visits[]; };
layout(set = 0, binding = 1, scalar) readonly buffer List { uint list[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Count { uint itemCount; };

void main() {
  const uint i = radivoxItemIndex();
  if (i >= itemCount) return;
  atomicAdd(visits[kThroughList ? list[i] : i], 1u);
}
