#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Enters the seed cell of every face into the table. A cell's founder is its lowest face.
#include "clustered_voxel/cluster/cluster_common.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 2, scalar) buffer Keys { uint slotKeys[]; };       // kNone: free
layout(set = 0, binding = 3, scalar) buffer Founders { uint slotFounders[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer FaceCells { uint faceCells[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  uint key = seedCellKey(voxelCoordinate(faceAt(s).key >> 3));
  uint slot = firstSlot(key);
  // At most half of the slots are ever taken, so a free one is found.
  for (uint probe = 0; probe < push.hashSize; ++probe) {
    uint found = atomicCompSwap(slotKeys[slot], kNone, key);
    if (found == kNone || found == key) break;
    slot = nextSlot(slot);
  }
  atomicMin(slotFounders[slot], s);
  faceCells[s] = slot;
}
