#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// Rays of one chunk of voxel faces. A lane traces kRaysPerLane rays of one face; lanes that sit together trace the same rays of
// faces that look the same way (see sort_rows.comp). See modules/clustered_voxel/visibility/visibility.h.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "clustered_voxel/visibility/trace.glsl"
layout(set = 0, binding = 11, scalar) writeonly buffer Hits { uint hits[]; };  // M a row
layout(set = 0, binding = 22, scalar) readonly buffer Todo { uint todo[]; };    // rayWords(M) a row
layout(constant_id = 7) const bool kSkyImage = false;  // misses are kept by finer bins
layout(constant_id = 8) const bool kSomeRays = false;  // only those of `todo`, whose rows are the first order[kRowsPerChunk] of `order`

uint hitWord(uint face, float time, vec3 direction) {
  if (face == kHitNothing) return kMissHit + skyBin(direction, kSkyImage);
  if (face == kHitBack) return kMissHit + kSkyBinCount;
  return face | (time <= nearDistance ? kNearHit : 0u) | (time <= kCloseDistance ? kCloseHit : 0u);
}

void main() {
  castBegin();
  uint lanes = (rowCount + 63u) & ~63u;
  uint item = radivoxItemIndex();
  uint slot = item % lanes;
  uint first = (item / lanes) * kRaysPerLane;
  uint rows = kSomeRays ? order[kRowsPerChunk] : rowCount;
  if (kSomeRays && slot - gl_LocalInvocationID.x >= rows) return;  // the whole group, but of others no lane (see castMarch):
  // those without a row follow the last one's and write nothing.
  uint row = order[min(slot, rows - 1u)];
  uint left = rayBits(rayCount, first);  // rays to go, a bit each
  if (kSomeRays) left = todo[row * rayWords(rayCount) + first / kRaysPerLane];
  if (slot >= rows) left = 0u;
  bool idle = left == 0u;
  uint at = first;
  uint s = firstFace + row;
  Start start = startOf(s);

  if (kNear) {
    for (; subgroupAny(left != 0u); left &= left - 1u) {
      at = left != 0u ? first + uint(findLSB(left)) : at;
      vec3 about;
      uint own;
      TraversalRay way = rayFromPiece(start, at, about, own);
      WalkHit hit = walkRay(way, voxelAt(way.origin), start.excluded, own, kPieceLift, triangleDistance, rayRandom(start.seed, at), left != 0u);
      if (left != 0u) hits[row * rayCount + at] = hitWord(hit.face, hit.time, way.direction);
    }
    return;
  }

  // Lanes go on to their next ray each on its own; those that wait do so only for the longest march.
  TraversalRay way = makeTraversalRay(start.origin, start.normal);
  TraversalCursor cursor = TraversalCursor(vec3(start.voxel), 0.0);
  uint inFront = 0u;
  bool fresh = true;
  uint last = 0u;
  while (subgroupAny(left != 0u)) {
    bool busy = left != 0u;
    at = busy ? first + uint(findLSB(left)) : at;
    TraversalRay next = makeTraversalRay(start.origin, alongNormal(decodeDirection(directions[start.directions + at]), start.normal));
    way.direction = mix(way.direction, next.direction, bvec3(fresh));
    way.inverse = mix(way.inverse, next.inverse, bvec3(fresh));
    way.forward = mix(way.forward, next.forward, bvec3(fresh));
    cursor.voxel = mix(cursor.voxel, vec3(start.voxel), bvec3(fresh));
    cursor.time = fresh ? 0.0 : cursor.time;
    inFront = fresh ? 0u : inFront;
    // On from the voxel just looked at, or from the face's own if there is nothing else in it.
    bool stay = fresh && (start.crowded || kFrame == 1);
    TraversalCursor stepped = cursor;
    traversalStep(way, stepped);
    cursor.voxel = mix(stepped.voxel, cursor.voxel, bvec3(stay));
    cursor.time = stay ? cursor.time : stepped.time;
    bool atStart = fresh && start.crowded;
    if (castMarch(way, cursor, busy && !atStart)) inFront = 0u;
    bool outside = isOutside(cursor.voxel);
    uint hit = castFace(way, cursor, busy, atStart ? start.excluded : 0u, inFront, rayRandom(start.seed, at));
    fresh = !busy || outside || hit != kHitNothing;
    uint result = hitWord(outside ? kHitNothing : hit, cursor.time, way.direction);
    // Written in every pass: overwritten until the ray is done, and again as it was once all are.
    last = busy ? result : last;
    if (!idle) hits[row * rayCount + at] = last;
    left = fresh ? left & (left - 1u) : left;
  }
}
