#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Faces follow their piece's link and enter themselves in the new piece's size and members. The old piece is no root any more, so its
// own entries are left as they are.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Links { uint links[]; };
layout(set = 0, binding = 1, scalar) buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 2, scalar) buffer Small { uint small[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint piece = pieces[s];
  uint link = links[piece];
  if (link == piece) return;
  pieces[s] = link;
  // At most three faces hand themselves over; to a large piece only the size matters.
  uint slot = atomicAdd(small[4u * link], 1u);
  if (slot < kMostMergeFaces) small[4u * link + 1u + slot] = s;
}
