#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The order in which lanes take the rows of a chunk: by direction, then as they come. Neighbouring lanes then trace nearly the same
// rays from nearby voxels. Results do not depend on this order. One workgroup: a stable counting sort, a lane per direction and part.
layout(local_size_x = 128) in;
#include "clustered_voxel/visibility/visibility.h"
layout(set = 0, binding = 0, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Order { uint order[]; };
layout(push_constant, scalar) uniform Push {
  uint firstFace;
  uint rowCount;
};

const uint kParts = 16u;
const uint kBins = kFaceCount * kParts;
const uint kWords = kRowsPerChunk / 4u;
shared uint keys[kWords];  // direction of each row, a byte each; 255: no row
shared uint counts[kBins];

void main() {
  uint lane = gl_LocalInvocationID.x;
  for (uint w = lane; w < kWords; w += 128u) {
    uint packed = 0u;
    for (uint b = 0u; b < 4u; ++b) {
      uint row = 4u * w + b;
      uint key = row < rowCount ? faces[firstFace + row].key & 7u : 255u;
      packed |= key << (8u * b);
    }
    keys[w] = packed;
  }
  barrier();
  uint key = lane / kParts;
  uint firstWord = (lane % kParts) * (kWords / kParts);
  uint endWord = firstWord + kWords / kParts;
  if (lane < kBins) {
    uint count = 0u;
    for (uint w = firstWord; w < endWord; ++w) {
      uint packed = keys[w];
      for (uint b = 0u; b < 4u; ++b) count += ((packed >> (8u * b)) & 0xffu) == key ? 1u : 0u;
    }
    counts[lane] = count;
  }
  barrier();
  if (lane < kBins) {
    uint next = 0u;
    for (uint bin = 0u; bin < lane; ++bin) next += counts[bin];
    for (uint w = firstWord; w < endWord; ++w) {
      uint packed = keys[w];
      for (uint b = 0u; b < 4u; ++b) {
        if (((packed >> (8u * b)) & 0xffu) != key) continue;
        order[next++] = 4u * w + b;
      }
    }
  }
}
