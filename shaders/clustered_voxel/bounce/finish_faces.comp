#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// B_s = ρ_s (E_dir,s + E_emit,c + E_ind,c): direct light at the detail of faces, the rest from the face's cluster.
#include "clustered_voxel/bounce/bounce_types.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Direct { vec3 faceIrradiance[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Received { vec3 received[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Indirect { vec3 indirect[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer Radiosity { vec3 radiosity[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint c = labels[s];
  vec3 irradiance = faceIrradiance[s] + indirect[c];
  if (push.hasEmission != 0u) irradiance += received[c];
  radiosity[s] = decodeAlbedo(faces[s].albedo) * irradiance;
}
