#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// B_c = b + ρ_c E_ind: reflected radiosity, without emission.
#include "clustered_voxel/bounce/bounce_types.h"
#include "shared/dispatch.glsl"
#include "shared/voxel.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Source { vec3 source[]; };
layout(set = 0, binding = 2, scalar) buffer Radiosity { vec3 radiosity[]; };  // E_ind before

void main() {
  uint c = radivoxItemIndex();
  if (c < push.clusterCount) radiosity[c] = source[c] + clusters[c].albedo * radiosity[c];
}
