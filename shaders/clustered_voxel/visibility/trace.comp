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
  if (slot >= rows) return;
  uint row = order[slot];
  uint left = rayBits(rayCount, first);  // rays to go, a bit each
  if (kSomeRays) left = todo[row * rayWords(rayCount) + first / kRaysPerLane];
  uint at = first;
  uint s = firstFace + row;
  Start start = startOf(s);

  if (kNear) {
    for (; left != 0u; left &= left - 1u) {
      at = first + uint(findLSB(left));
      vec3 about;
      uint own;
      TraversalRay way = rayFromPiece(start, at, about, own);
      WalkHit hit = walkRay(way, voxelAt(way.origin), start.excluded, kWholeList, own, kPieceLift, triangleDistance, rayRandom(start.seed, at));
      hits[row * rayCount + at] = hitWord(hit.face, hit.time, way.direction);
    }
    return;
  }

  // One loop over the voxels of all of a lane's rays, so that lanes go on to their next ray each on its own.
  TraversalRay way;
  TraversalCursor cursor;
  uint inFront = 0u;
  bool fresh = true;
  while (left != 0u) {
    if (fresh) {
      at = first + uint(findLSB(left));
      way = makeTraversalRay(start.origin, alongNormal(decodeDirection(directions[start.directions + at]), start.normal));
      cursor = TraversalCursor(vec3(start.voxel), 0.0);
      inFront = 0u;
    }
    // On from the voxel just looked at, or from the face's own if there is nothing else in it.
    if (!fresh || !(start.crowded || kFrame == 1)) traversalStep(way, cursor);
    bool atStart = fresh && start.crowded;
    uint voxel;
    if (castMarch(way, cursor, !atStart, voxel)) inFront = 0u;
    bool outside = isOutside(cursor.voxel);
    uint hit = castFace(way, cursor, voxel, atStart ? start.excluded : 0u, inFront, rayRandom(start.seed, at));
    fresh = outside || hit != kHitNothing;
    if (fresh) {
      hits[row * rayCount + at] = hitWord(outside ? kHitNothing : hit, cursor.time, way.direction);
      left &= left - 1u;
    }
  }
}
