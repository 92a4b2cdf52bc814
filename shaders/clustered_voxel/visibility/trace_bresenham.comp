#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The paper's rays (4.3): Bresenham's line in three dimensions, one voxel a step along the dominant axis, to the first voxel with
// faces. It is 26-connected and may slip between voxels that meet at an edge. Same rows and buffers as trace.comp.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
layout(constant_id = 2) const uint kFrame = 1;
layout(constant_id = 7) const bool kSkyImage = false;  // misses are kept by finer bins

#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_VOXELS 3
#define RADIVOX_BIND_PLANES 5
#define RADIVOX_BIND_CAST_FIRST 6
#define RADIVOX_BIND_FACES 7
#define RADIVOX_SKIP kSkipNothing
#define RADIVOX_HIT kHitVoxel
#define RADIVOX_BIND_PLANE_EXTRAS 12
#define RADIVOX_VOXEL_COUNT voxelCount
layout(set = 0, binding = 9, scalar) uniform Directions { uint directions[kShiftCount * kMaxRays]; };  // M a shift
layout(set = 0, binding = 10, scalar) readonly buffer Order { uint order[]; };
layout(set = 0, binding = 11, scalar) writeonly buffer Hits { uint hits[]; };
layout(set = 0, binding = 22, scalar) readonly buffer Todo { uint todo[]; };  // rayWords(M) a row
layout(constant_id = 8) const bool kSomeRays = false;  // see trace.comp
layout(push_constant, scalar) uniform Push {
  uint firstFace;
  uint rowCount;
  uint rayCount;
  float nearDistance;
  uint voxelCount;
};
#include "shared/dispatch.glsl"
#include "shared/voxel_cast.glsl"

void main() {
  castBegin();
  uint lanes = (rowCount + 63u) & ~63u;
  uint item = radivoxItemIndex();
  uint slot = item % lanes;
  uint ray = (item / lanes) * kRaysPerLane;
  uint rows = kSomeRays ? order[kRowsPerChunk] : rowCount;
  if (slot >= rows || ray >= rayCount) return;
  uint row = order[slot];
  uint left = rayBits(rayCount, ray);
  if (kSomeRays) left = todo[row * rayWords(rayCount) + ray / kRaysPerLane];
  uint first = ray;
  uint s = firstFace + row;
  Face face = faceAt(s);
  uint packed = packedVoxel(face.key >> 3);
  uvec3 coordinate = unpackVoxel(packed);
  uint seed = faceSeed(packed, face.key & 7u);
  vec3 n = kFrame == 1 ? faceVector(face.key & 7u) : decodeNormal(face.normal);
  int reach = int(max(grid.size.x, max(grid.size.y, grid.size.z)));
  uint table = shiftOf(seed) * rayCount;

  for (; left != 0u; left &= left - 1u) {
    ray = first + uint(findLSB(left));
    TraversalRay way = makeTraversalRay(vec3(0.0), alongNormal(decodeDirection(directions[table + ray]), n));
    vec3 a = abs(way.direction);
    uint axis = a.x >= a.y && a.x >= a.z ? 0u : (a.y >= a.z ? 1u : 2u);
    // The line ends `reach` voxels along the dominant axis: beyond the grid.
    precise vec3 target = way.direction * abs(way.inverse[axis]) * float(reach);
    precise vec3 rounded = floor(target + 0.5);
    ivec3 delta = ivec3(rounded);
    ivec3 side = sign(delta);
    delta = abs(delta);
    precise float pace = abs(way.inverse[axis]);  // length of a step
    // The ray leaves its own voxel first; about an axis, from the voxel in front of the face.
    ivec3 voxel = ivec3(coordinate) + (kFrame == 1 ? ivec3(n) : ivec3(0));
    ivec3 error = ivec3(reach);
    uint hit = kHitNothing;
    int i = 0;
    bool skip = kFrame != 1;
    while (true) {
      if (!isInside(voxel)) break;
      uint none = 0u;
      if (!skip) hit = castFace(way, TraversalCursor(vec3(voxel), 0.0), voxelIndex(voxel), 0u, none, rayRandom(seed, ray));
      if (hit != kHitNothing) break;
      skip = false;
      ++i;
      error += 2 * delta;
      ivec3 moves = ivec3(greaterThanEqual(error, ivec3(2 * reach)));
      voxel += moves * side;
      error -= moves * 2 * reach;
    }
    precise float distance = float(i) * pace;
    uint result = hit | (distance <= nearDistance ? kNearHit : 0u) | (distance <= kCloseDistance ? kCloseHit : 0u);
    if (hit == kHitBack) result = kMissHit + kSkyBinCount;
    if (hit == kHitNothing) result = kMissHit + skyBin(way.direction, kSkyImage);
    hits[row * rayCount + ray] = result;
  }
}
