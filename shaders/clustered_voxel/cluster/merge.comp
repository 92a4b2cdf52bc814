#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// A small piece joins the one it chose if that stays where it is: it chose none (large ones never do), or it is the lower of two that
// chose each other. So pieces hang one deep and stay connected.
#include "clustered_voxel/cluster/cluster_common.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Targets { uint targets[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Links { uint links[]; };
layout(set = 0, binding = 2, scalar) buffer Control { ClusterControl control; };

void main() {
  uint piece = radivoxItemIndex();
  if (piece >= push.faceCount) return;
  uint link = piece;
  uint target = targets[piece];
  if (target != kNone) {
    uint onward = targets[target];
    if (onward == kNone || (onward == piece && target < piece)) {
      link = target;
      atomicAdd(control.mergedCount, 1u);
    }
  }
  links[piece] = link;
}
