// Push constants, seed cells and the distance of clustered_voxel.cluster. All arithmetic is exact or correctly rounded and marked
// precise, so that labels have the same bits on every device.
#ifndef RADIVOX_CLUSTER_COMMON_GLSL
#define RADIVOX_CLUSTER_COMMON_GLSL
#include "clustered_voxel/cluster/cluster_types.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"

layout(push_constant, scalar) uniform Push { ClusterPush push; };

struct Seed {
  vec3 position;  // grid space
  vec3 normal;    // unit
};

uint seedCellKey(uvec3 voxel) { return packVoxel(voxel / push.spacing); }

// The table of seed cells is open addressed; with at most half of its slots taken a probe ends soon.
uint firstSlot(uint key) {
  uint high, low;
  umulExtended(key * 2654435761u, push.hashSize, high, low);
  return high;
}
uint nextSlot(uint slot) { return slot + 1u == push.hashSize ? 0u : slot + 1u; }

// The signed axis nearest to n, as faces are numbered; the lower axis wins a tie.
uint dominantDirection(vec3 n) {
  vec3 a = abs(n);
  uint axis = a.x >= a.y ? (a.x >= a.z ? 0u : 2u) : (a.y >= a.z ? 1u : 2u);
  return axis << 1 | (n[axis] < 0.0 ? 1u : 0u);
}

// Direction bin for faces that no seed accepts: each side of the cube of directions is cut into orphanBins² squares.
uint directionBin(vec3 n) {
  uint f = dominantDirection(n);
  uint axis = f >> 1;
  precise float scale = preciseReciprocal(abs(n[axis]));
  precise float u = n[axis == 0u ? 1 : 0] * scale;
  precise float v = n[axis == 2u ? 1 : 2] * scale;
  precise float halfBins = 0.5 * float(push.orphanBins);
  precise float cellU = floor((u + 1.0) * halfBins);
  precise float cellV = floor((v + 1.0) * halfBins);
  float last = float(push.orphanBins - 1u);
  uint column = uint(clamp(cellU, 0.0, last));
  uint row = uint(clamp(cellV, 0.0, last));
  return (f * push.orphanBins + row) * push.orphanBins + column;
}

float cosineBetween(vec3 a, vec3 b) {
  precise float c = a.x * b.x + a.y * b.y + a.z * b.z;
  return c;
}

// D² = space weight · |x_s − x_c|² / S² + normal weight · (1 − n_s·n_c) / (1 − cos angle). The caller rejects cosine < cosAngle.
float squaredDistance(vec3 position, Seed seed, float cosine) {
  precise vec3 offset = position - seed.position;
  precise float squared = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
  precise float d = squared * push.spaceScale + (1.0 - cosine) * push.normalScale;
  return d;
}

#endif
