#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// B_s = ρ_s (E_dir,s + E_emit + E_ind): direct light at the detail of faces; the rest as the face's cluster received it. One lane a cluster, so that
// no face needs to know its cluster.
#include "clustered_voxel/bounce/bounce_types.h"
#include "shared/cluster_member.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Members { uint members[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Direct { vec3 faceIrradiance[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Received { vec3 received[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Indirect { vec3 indirect[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer Radiosity { vec3 radiosity[]; };

void main() {
  uint c = radivoxItemIndex();
  if (c >= push.clusterCount) return;
  uint end = clusters[c + 1u].firstMember;
  for (uint i = clusters[c].firstMember; i < end; ++i) {
    uint s = memberFace(members[i]);
    vec3 irradiance = faceIrradiance[s] + indirect[c];
    if (push.hasEmission != 0u) irradiance += received[c];
    radiosity[s] = decodeAlbedo(faces[s].albedo) * irradiance;
  }
}
