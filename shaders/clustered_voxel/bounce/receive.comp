#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// E_ind of each cluster: what the last sweep received, F times the iterate that it read, once more. While sweeps run, their steps lie where this goes.
#include "clustered_voxel/bounce/row_product.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Iterate { vec3 iterate[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Indirect { vec3 indirect[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Control { BounceControl control; };

void main() {
  uint readFrom = ((control.iterations + 1u) & 1u) * push.clusterCount;
  vec3 least = leastIterate(control.phase);
  uint c = rowOfLane();
  vec3 received;
#define RADIVOX_VECTOR(i) max(iterate[readFrom + (i)], least)
  radivoxRowProduct(c, received);
  if (isFirstOfRow() && c < push.clusterCount) indirect[c] = control.iterations > 0u ? max(received, vec3(0.0)) : vec3(0.0);
}
