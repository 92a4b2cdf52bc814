#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Joins faces of the same seed whose voxels touch (26 neighbours, or the same voxel) with a lock-free union-find, one lane a voxel.
// The higher root is hung below the lower, so a piece's root is its lowest face whatever the order. A failed exchange means that the
// root has sunk since, so every loop ends. Faces that no seed accepted join those of their own seed cell and direction bin.
#include "clustered_voxel/cluster/cluster_common.glsl"
#include "clustered_voxel/structure.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 6, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 7, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 8, scalar) readonly buffer FaceCells { uint faceCells[]; };
layout(set = 0, binding = 9, scalar) coherent volatile buffer Parents { uint parents[]; };

uint findRoot(uint s) {
  uint parent = parents[s];
  while (parent != s) {
    uint above = parents[parent];
    if (above != parent) parents[s] = above;  // s is no root and never will be: only shortens its way
    s = parent;
    parent = above;
  }
  return s;
}

void unite(uint a, uint b) {
  uint high = findRoot(a);
  uint low = findRoot(b);
  while (high != low) {
    if (high < low) {
      uint swapped = high;
      high = low;
      low = swapped;
    }
    uint found = atomicCompSwap(parents[high], high, low);
    if (found == high) return;
    high = findRoot(found);
  }
}

bool belongTogether(uint a, uint b, uint label) {
  if (seedLabels[b] != label) return false;
  if (label != kNone) return true;
  return faceCells[a] == faceCells[b] &&
         directionBin(decodeNormal(faces[a].normal)) == directionBin(decodeNormal(faces[b].normal));
}

void main() {
  uint v = radivoxItemIndex();
  if (v >= push.voxelCount) return;
  uint mask = faceMasks[v];
  if (mask == 0u) return;
  uint begin = firstFaces[v];
  uint end = begin + uint(bitCount(mask));
  for (uint a = begin + 1u; a < end; ++a) {
    uint label = seedLabels[a];
    for (uint b = begin; b < a; ++b)
      if (belongTogether(a, b, label)) unite(a, b);
  }
  ivec3 coordinate = ivec3(unpackVoxel(voxels[v]));
  // Half of the neighbourhood: the other half sees us.
  for (uint step = 0; step < 13u; ++step) {
    uint other = voxelIndex(coordinate + ivec3(step % 3u, (step / 3u) % 3u, step / 9u) - 1);
    if (other == kNone) continue;
    uint otherBegin = firstFaces[other];
    uint otherEnd = otherBegin + uint(bitCount(faceMasks[other]));
    for (uint a = begin; a < end; ++a) {
      uint label = seedLabels[a];
      for (uint b = otherBegin; b < otherEnd; ++b)
        if (belongTogether(a, b, label)) unite(a, b);
    }
  }
}
