#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Rays of one chunk of voxel faces. A lane traces kRaysPerLane rays of one face; lanes that sit together trace the same rays of
// faces that look the same way (see sort_rows.comp). See modules/clustered_voxel/visibility/visibility.h.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSkip = 2;
layout(constant_id = 1) const uint kHit = 0;
layout(constant_id = 2) const uint kFrame = 0;  // 0: about n_s from x_s; 1: about e_f from the middle of the voxel's side (paper)

#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_VOXELS 3
#define RADIVOX_BIND_DISTANCE 4
#define RADIVOX_BIND_PLANES 5
#define RADIVOX_BIND_CAST_FIRST 6
#define RADIVOX_BIND_FACES 7
#define RADIVOX_BIND_CLEARANCE 8
#define RADIVOX_SKIP kSkip
#define RADIVOX_HIT kHit
#define RADIVOX_BIND_PLANE_EXTRAS 12
#define RADIVOX_VOXEL_COUNT voxelCount
layout(set = 0, binding = 9, scalar) readonly buffer Directions { vec3 directions[]; };  // M a rotation
layout(set = 0, binding = 10, scalar) readonly buffer Order { uint order[]; };          // rows of the chunk as lanes take them
layout(set = 0, binding = 11, scalar) writeonly buffer Hits { uint hits[]; };            // M a row
layout(push_constant, scalar) uniform Push {
  uint firstFace;  // of the chunk
  uint rowCount;
  uint rayCount;
  float nearDistance;  // voxels; hits up to here keep their face
  uint voxelCount;
};
#include "clustered_voxel/visibility/visibility.h"
#include "shared/dispatch.glsl"
#include "shared/voxel_cast.glsl"

void main() {
  castBegin();
  uint lanes = (rowCount + 63u) & ~63u;
  uint item = radivoxItemIndex();
  uint slot = item % lanes;
  uint ray = (item / lanes) * kRaysPerLane;
  if (slot >= rowCount || ray >= rayCount) return;
  uint end = min(ray + kRaysPerLane, rayCount);
  uint row = order[slot];
  uint s = firstFace + row;
  Face face = faces[s];
  uint startVoxel = face.key >> 3;
  uvec3 coordinate = voxelCoordinate(startVoxel);
  vec3 position = facePosition(face, coordinate);
  vec3 n = decodeNormal(face.normal);
  vec3 origin = liftedOrigin(position, n, coordinate);
  vec3 start = vec3(coordinate);
  uint excluded = 0x3fu;
  bool crowded = false;  // other surface in the voxel of the face
  if (kFrame == 1) {
    n = faceVector(face.key & 7u);
    start += n;
    origin = vec3(coordinate) + 0.5 + 0.5 * n;
  } else if (kHit == kHitPlane) {
    excluded = ownPlanes(startVoxel, coordinate, position, n, crowded);
  }
  uint table = rotationOf(s) * rayCount;

  // Lanes go on to their next ray each on its own; those that wait do so only for the longest march.
  TraversalRay way;
  TraversalCursor cursor;
  uint inFront = 0u;
  bool fresh = true;
  bool atStart = false;
  while (ray < end) {
    if (fresh) {
      way = makeTraversalRay(origin, alongNormal(directions[table + ray], n));
      cursor = TraversalCursor(start, 0.0);
      inFront = 0u;
      atStart = crowded;
      if (kFrame == 0 && !crowded) traversalStep(way, cursor);
    }
    if (!atStart && castMarch(way, cursor)) inFront = 0u;
    uint hit = kHitNothing;
    bool outside = isOutside(cursor.voxel);
    if (!outside) hit = castFace(way, cursor, atStart ? excluded : 0u, inFront, rayRandom(s, ray));
    fresh = outside || hit != kHitNothing;
    atStart = false;
    if (fresh) {
      uint result = cursor.time <= nearDistance ? hit | kNearHit : hit;
      if (hit == kHitBack) result = kMissHit + 6u;
      if (outside) result = kMissHit + directionBin(way.direction);
      hits[row * rayCount + ray] = result;
      ++ray;
    } else {
      traversalStep(way, cursor);
    }
  }
}
