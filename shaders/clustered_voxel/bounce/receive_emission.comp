#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// E_emit = F B_e: what clusters receive from emitters straight away.
#include "clustered_voxel/bounce/row_product.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Mean { vec3 meanEmission[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Received { vec3 received[]; };
#define RADIVOX_VECTOR(i) meanEmission[i]

void main() {
  uint c = rowOfLane();
  vec3 product;
  radivoxRowProduct(c, product);
  if (isFirstOfRow() && c < push.clusterCount) received[c] = product;
}
