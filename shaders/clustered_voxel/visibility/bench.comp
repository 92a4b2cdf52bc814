#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// For `radivox bench`: the rays of a chunk of voxel faces, and casting them as trace.comp does, one a lane. Rays lie in the order in which lanes
// take them: the first ray of all rows, then the second.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/bench.h"
#include "clustered_voxel/visibility/visibility.h"
#include "clustered_voxel/visibility/trace.glsl"
layout(constant_id = 5) const uint kTask = kBenchRays;
layout(set = 0, binding = 11, scalar) buffer Rays { BenchRay rays[]; };
layout(set = 0, binding = 22, scalar) writeonly buffer Times { float times[]; };  // voxels; negative: nothing was hit

void writeRay(uint row, uint at, uint place) {
  Start start = startOf(firstFace + row);
  uint own;
  vec3 about;
  TraversalRay way = rayFromPiece(start, at, about, own);
  precise vec3 origin = way.origin + (kTask == kBenchLifted ? kBenchLift : 0.0) * about;
  rays[place] = BenchRay(origin, start.excluded, way.direction, own);
}

float castRay(BenchRay ray, uint random) {
  TraversalRay way = makeTraversalRay(ray.origin, ray.direction);
  if (kTask == kBenchTraversal) {
    TraversalCursor cursor;
    bool enters = traversalBegin(way, vec3(castSize), cursor);
    if (!enters) cursor = TraversalCursor(vec3(-1.0), 0.0);
    uint voxel;
    castMarch(way, cursor, enters, voxel);
    return isOutside(cursor.voxel) ? -1.0 : cursor.time;
  }
  float triangles = kTask == kBenchWalk ? triangleDistance : 0.0;
  WalkHit hit = walkRay(way, voxelAt(ray.origin), ray.excluded, kWholeList, ray.own, kPieceLift, triangles, random);
  return hit.face == kHitNothing ? -1.0 : hit.time;
}

void main() {
  castBegin();
  uint lanes = (rowCount + 63u) & ~63u;
  uint item = radivoxItemIndex();
  uint slot = item % lanes;
  uint at = item / lanes;
  if (slot >= rowCount || at >= rayCount) return;
  uint place = at * rowCount + slot;
  if (kTask <= kBenchLifted) {
    writeRay(order[slot], at, place);
    return;
  }
  times[place] = castRay(rays[place], rayRandom(slot, at));
}
