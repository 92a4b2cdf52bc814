#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Shares of the members of each cluster (shared/cluster_member.h), by the weights of clustered_voxel.visibility. Where nobody sees any of them they
// stay 0.
#include "shared/cluster_member.h"
#include "shared/dispatch.glsl"
#include "shared/voxel.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint clusterCount; };
layout(set = 0, binding = 0, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 1, scalar) buffer Members { uint members[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Weights { uint weights[]; };

void main() {
  uint c = radivoxItemIndex();
  if (c >= clusterCount) return;
  uint begin = clusters[c].firstMember, end = clusters[c + 1u].firstMember;
  uint greatest = 0u;
  for (uint i = begin; i < end; ++i) greatest = max(greatest, weights[members[i]]);
  if (greatest == 0u) return;
  for (uint i = begin; i < end; ++i) members[i] = memberWith(members[i], weights[members[i]], greatest);
}
