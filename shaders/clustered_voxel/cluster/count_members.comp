#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Faces of each cluster.
#include "shared/dispatch.glsl"
#include "shared/types.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint faceCount; };
layout(set = 0, binding = 0, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 1, scalar) buffer Starts { uint starts[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s < faceCount) atomicAdd(starts[labels[s]], 1u);
}
