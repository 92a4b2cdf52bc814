#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// x₀ of the solver.
#include "clustered_voxel/bounce/bounce_types.h"
#include "shared/dispatch.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Source { vec3 source[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Control { BounceControl control; };
layout(set = 0, binding = 2, scalar) writeonly buffer Iterate { vec3 iterate[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Steps { vec3 steps[]; };

void main() {
  uint c = radivoxItemIndex();
  if (c >= push.clusterCount) return;
  iterate[c] = push.startBelow != 0u ? -uintBitsToFloat(control.source) : source[c];
  steps[c] = vec3(0.0);
}
