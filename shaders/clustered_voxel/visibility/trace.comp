#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Rays of one chunk of voxel faces. A lane traces kRaysPerLane rays of one face; lanes that sit together trace the same rays of
// faces that look the same way (see sort_rows.comp). See modules/clustered_voxel/visibility/visibility.h.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
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
layout(set = 0, binding = 9, scalar) uniform Directions { uint directions[kShiftCount * kMaxRays]; };  // M a shift
layout(set = 0, binding = 10, scalar) readonly buffer Order { uint order[]; };          // rows of the chunk as lanes take them
layout(set = 0, binding = 11, scalar) writeonly buffer Hits { uint hits[]; };            // M a row
layout(push_constant, scalar) uniform Push {
  uint firstFace;  // of the chunk
  uint rowCount;
  uint rayCount;
  float nearDistance;  // voxels; hits up to here keep their face
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
  uint end = min(ray + kRaysPerLane, rayCount);
  // No lane leaves early (see castMarch): those without a row follow the last one's and write nothing.
  bool idle = slot >= rowCount;
  uint row = order[min(slot, rowCount - 1u)];
  if (idle) end = ray;
  uint s = firstFace + row;
  Face face = faces[s];
  uvec3 coordinate = voxelCoordinate(face.key >> 3);
  vec3 position = facePosition(face, coordinate);
  vec3 n = decodeNormal(face.normal);
  vec3 origin = liftedOrigin(position, n);
  // The lift may lead over the border: a scrap of surface in a voxel's corner lies behind its neighbour's plane.
  ivec3 start = clamp(ivec3(floor(origin)), ivec3(0), ivec3(castSize) - 1);
  uint excluded = 0x3fu;
  bool crowded = false;  // other surface where the rays start
  if (kFrame == 1) {
    n = faceVector(face.key & 7u);
    start = ivec3(coordinate) + ivec3(n);
    origin = vec3(coordinate) + 0.5 + 0.5 * n;
  } else if (kHit == kHitPlane) {
    uint voxel = voxelIndex(start);
    if (voxel != kNone) excluded = ownPlanes(voxel, uvec3(start), position, n, crowded);
  } else {
    start = ivec3(coordinate);
  }
  uint table = shiftOf(s) * rayCount;

  // Lanes go on to their next ray each on its own; those that wait do so only for the longest march.
  TraversalRay way = makeTraversalRay(origin, n);
  TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
  uint inFront = 0u;
  bool fresh = true;
  uint last = 0u;
  while (subgroupAny(ray < end)) {
    bool busy = ray < end;
    uint at = busy ? ray : max(ray, 1u) - 1u;
    TraversalRay next = makeTraversalRay(origin, alongNormal(decodeDirection(directions[table + at]), n));
    way.direction = mix(way.direction, next.direction, bvec3(fresh));
    way.inverse = mix(way.inverse, next.inverse, bvec3(fresh));
    way.forward = mix(way.forward, next.forward, bvec3(fresh));
    cursor.voxel = mix(cursor.voxel, vec3(start), bvec3(fresh));
    cursor.time = fresh ? 0.0 : cursor.time;
    inFront = fresh ? 0u : inFront;
    // On from the voxel just looked at, or from the face's own if there is nothing else in it.
    bool stay = fresh && (crowded || kFrame == 1);
    TraversalCursor stepped = cursor;
    traversalStep(way, stepped);
    cursor.voxel = mix(stepped.voxel, cursor.voxel, bvec3(stay));
    cursor.time = stay ? cursor.time : stepped.time;
    bool atStart = fresh && crowded;
    if (castMarch(way, cursor, busy && !atStart)) inFront = 0u;
    bool outside = isOutside(cursor.voxel);
    uint hit = castFace(way, cursor, busy, atStart ? excluded : 0u, inFront, rayRandom(s, at));
    fresh = !busy || outside || hit != kHitNothing;
    uint result = hit | (cursor.time <= nearDistance ? kNearHit : 0u) | (cursor.time <= kCloseDistance ? kCloseHit : 0u);
    result = hit == kHitBack ? kMissHit + 6u : result;
    result = outside ? kMissHit + directionBin(way.direction) : result;
    // Written in every pass: overwritten until the ray is done, and again as it was once all are.
    last = busy ? result : last;
    if (!idle) hits[row * rayCount + at] = last;
    ray += fresh && busy ? 1u : 0u;
  }
}
