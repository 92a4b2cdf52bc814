#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The piece (lowest face) of every face; the size of each piece, and the first three members of the small ones.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Parents { uint parents[]; };
layout(set = 0, binding = 1, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 3, scalar) buffer Small { uint small[]; };  // 4 a piece: size, then members
layout(set = 0, binding = 4, scalar) buffer Control { ClusterControl control; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint root = s;
  while (parents[root] != root) root = parents[root];
  pieces[s] = root;
  uint slot = atomicAdd(small[4u * root], 1u);
  if (slot < kMostMergeFaces) small[4u * root + 1u + slot] = s;
  if (root == s) atomicAdd(control.pieceCount, 1u);
  if (seedLabels[s] == kNone) atomicAdd(control.orphanCount, 1u);
}
