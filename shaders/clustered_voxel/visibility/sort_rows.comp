#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The order in which lanes take the rows of a chunk: by direction, then by how many triangles there are where their rays start, then as they come.
// Neighbouring lanes then trace nearly the same rays from nearby voxels and test about as many triangles. Results do not depend on this order.
// One workgroup: a stable counting sort, a lane per key and part.
layout(local_size_x = 128) in;
layout(constant_id = 0) const bool kLists = false;  // rays test triangles
#include "clustered_voxel/visibility/visibility.h"
layout(set = 0, binding = 0, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Order { uint order[]; };
layout(set = 0, binding = 2, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Todo { uint todo[]; };
layout(push_constant, scalar) uniform Push {
  uint firstFace;
  uint rowCount;
  uint wordCount;  // of `todo`, a row
};
layout(constant_id = 1) const bool kSomeRows = false;  // only those with rays to trace; order[kRowsPerChunk]: how many

bool isWanted(uint row) {
  if (!kSomeRows) return true;
  uint any_ = 0u;
  for (uint w = 0u; w < wordCount; ++w) any_ |= todo[row * wordCount + w];
  return any_ != 0u;
}

const uint kClasses = kLists ? 8u : 1u;
const uint kParts = 16u;
const uint kBins = kFaceCount * kClasses * kParts;
const uint kWords = kRowsPerChunk / 4u;
shared uint keys[kWords];  // of each row, a byte each; 255: no row
shared uint counts[kFaceCount * 8u * kParts];
shared uint sums[128];

// 0, 1, 2, 3…4, 5…8 and so on triangles: classes 0, 0, 1, 2, 3…
uint classOf(uint voxel) {
  uint length_ = triangleFirst[voxel + 1u] - triangleFirst[voxel];
  return min(uint(findMSB(2u * max(length_, 1u) - 1u)), 7u);
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  for (uint w = lane; w < kWords; w += 128u) {
    uint packed = 0u;
    for (uint b = 0u; b < 4u; ++b) {
      uint row = 4u * w + b;
      uint key = 255u;
      if (row < rowCount && isWanted(row)) {
        uint faceKey = faces[firstFace + row].key;
        key = (faceKey & 7u) * kClasses + (kLists ? classOf(faceKey >> 3) : 0u);
      }
      packed |= key << (8u * b);
    }
    keys[w] = packed;
  }
  barrier();
  for (uint bin = lane; bin < kBins; bin += 128u) {
    uint key = bin / kParts;
    uint first = (bin % kParts) * (kWords / kParts);
    uint count = 0u;
    for (uint w = first; w < first + kWords / kParts; ++w) {
      uint packed = keys[w];
      for (uint b = 0u; b < 4u; ++b) count += ((packed >> (8u * b)) & 0xffu) == key ? 1u : 0u;
    }
    counts[bin] = count;
  }
  barrier();
  // Exclusive sums: of a run of bins a lane, then of the lanes before.
  const uint kRun = (kBins + 127u) / 128u;
  uint sum = 0u;
  for (uint bin = lane * kRun; bin < min((lane + 1u) * kRun, kBins); ++bin) sum += counts[bin];
  sums[lane] = sum;
  barrier();
  uint next = 0u;
  for (uint l = 0u; l < lane; ++l) next += sums[l];
  if (kSomeRows && lane == 127u) order[kRowsPerChunk] = next + sums[lane];
  for (uint bin = lane * kRun; bin < min((lane + 1u) * kRun, kBins); ++bin) {
    uint key = bin / kParts;
    uint first = (bin % kParts) * (kWords / kParts);
    for (uint w = first; w < first + kWords / kParts; ++w) {
      uint packed = keys[w];
      for (uint b = 0u; b < 4u; ++b) {
        if (((packed >> (8u * b)) & 0xffu) != key) continue;
        order[next++] = 4u * w + b;
      }
    }
  }
}
