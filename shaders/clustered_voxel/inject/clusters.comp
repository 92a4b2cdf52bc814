#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Reflected direct light of each cluster: Σ w ρ E_dir / Σ w, w the shares of the members, or their areas where there are none; over members in ascending order, so the bits never vary.
#include "shared/cluster_member.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"
#include "shared/voxel.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer FacesBuffer { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer ClusterBuffer { Cluster clusters[]; };
layout(set = 0, binding = 2, scalar) readonly buffer MemberBuffer { uint members[]; };
layout(set = 0, binding = 3, scalar) readonly buffer IrradianceBuffer { vec3 irradiance[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer RadiosityBuffer { vec3 radiosity[]; };
layout(push_constant, scalar) uniform Push { uint clusterCount; };

void main() {
  uint c = radivoxItemIndex();
  if (c >= clusterCount) return;
  uint begin = clusters[c].firstMember, end = clusters[c + 1u].firstMember;
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (uint byArea = 0u; byArea < 2u && total == 0.0; ++byArea) {
    for (uint i = begin; i < end; ++i) {
      uint member = members[i];
      uint s = memberFace(member);
      float weight = byArea == 1u ? faces[s].area : float(memberShare(member));
      sum += weight * decodeAlbedo(faces[s].albedo) * irradiance[s];
      total += weight;
    }
  }
  radiosity[c] = total > 0.0 ? sum / total : vec3(0.0);
}
