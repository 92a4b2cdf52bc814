#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// b = what clusters reflect of direct light, the emitters' part (already received) added. Its maxima, and ρ · row sum as the first bound
// of the spectral radius of ρF.
#include "clustered_voxel/bounce/row_product.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Direct { vec3 direct[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Received { vec3 received[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer Source { vec3 source[]; };
layout(set = 0, binding = 5, scalar) buffer Control { BounceControl control; };
#define RADIVOX_VECTOR(i) vec3(1.0)

shared uint sharedSource[3];
shared uint sharedRadius[3];

void main() {
  uint lane = gl_LocalInvocationID.x;
  if (lane < 3u) sharedSource[lane] = sharedRadius[lane] = 0u;
  barrier();
  uint c = rowOfLane();
  vec3 rowSum;
  radivoxRowProduct(c, rowSum);
  if (isFirstOfRow() && c < push.clusterCount) {
    vec3 albedo = clusters[c].albedo;
    vec3 b = direct[c];
    if (push.hasEmission != 0u) {
      b += albedo * received[c];
      source[c] = b;  // otherwise it is `direct`
    }
    vec3 bound = albedo * (rowSum + 1e-6);
    for (uint k = 0; k < 3u; ++k) {
      atomicMax(sharedSource[k], floatBitsToUint(max(b[k], 0.0)));
      atomicMax(sharedRadius[k], floatBitsToUint(bound[k]));
    }
  }
  barrier();
  if (lane < 3u) {
    atomicMax(control.source[lane], sharedSource[lane]);
    atomicMax(control.radius[lane], sharedRadius[lane]);
  }
}
