#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// needed = shown and every same-direction face within `reach` voxels of a shown one (what the filter may read).
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 6, scalar) readonly buffer VoxelBuffer { uint voxels[]; };
layout(set = 0, binding = 7, scalar) readonly buffer ShownBuffer { uint shown[]; };
layout(set = 0, binding = 8, scalar) buffer NeededBuffer { uint needed[]; };
layout(push_constant, scalar) uniform Push {
  uint faceCount;
  uint reach;
};

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount || (shown[s >> 5] & (1u << (s & 31u))) == 0u) return;
  uint key = faceAt(s).key;
  ivec3 coord = ivec3(unpackVoxel(voxels[key >> 3]));
  int r = int(reach);
  for (int z = -r; z <= r; ++z)
    for (int y = -r; y <= r; ++y)
      for (int x = -r; x <= r; ++x) {
        uint voxel = voxelIndex(coord + ivec3(x, y, z));
        if (voxel == kNone) continue;
        uint t = faceIndex(voxel, key & 7u);
        if (t == kNone) continue;
        uint bit = 1u << (t & 31u);
        if ((needed[t >> 5] & bit) == 0u) atomicOr(needed[t >> 5], bit);
      }
}
