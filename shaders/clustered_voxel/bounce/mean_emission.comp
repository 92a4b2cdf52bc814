#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// B_e of each cluster: Σ w B_e / Σ w over its faces, in order; w: shares, or areas where there are none.
#include "clustered_voxel/bounce/bounce_types.h"
#include "clustered_voxel/compensated.glsl"
#include "shared/cluster_member.h"
#include "shared/dispatch.glsl"
#include "shared/voxel.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Members { uint members[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Emission { vec3 emission[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer Mean { vec3 meanEmission[]; };

void main() {
  uint c = radivoxItemIndex();
  if (c >= push.clusterCount) return;
  uint begin = clusters[c].firstMember, end = clusters[c + 1u].firstMember;
  CompensatedSum3 sum = CompensatedSum3(vec3(0.0), vec3(0.0));
  CompensatedSum total = CompensatedSum(0.0, 0.0);
  for (uint byArea = 0u; byArea < 2u && total.high == 0.0; ++byArea) {
    for (uint i = begin; i < end; ++i) {
      uint member = members[i];
      uint s = memberFace(member);
      float weight = byArea == 1u ? faces[s].area : float(memberShare(member));
      addTo(sum, weight * emission[s]);
      addTo(total, weight);
    }
  }
  meanEmission[c] = (sum.high + sum.low) / (total.high + total.low);
}
