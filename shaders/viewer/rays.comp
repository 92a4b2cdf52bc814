#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The rays of one voxel face again, exactly as clustered_voxel/visibility/trace.comp traces them, one a lane, with where they end.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
layout(constant_id = 1) const uint kHit = 0;
layout(constant_id = 2) const uint kFrame = 0;

#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_VOXELS 3
#define RADIVOX_BIND_DISTANCE 4
#define RADIVOX_BIND_PLANES 5
#define RADIVOX_BIND_CAST_FIRST 6
#define RADIVOX_BIND_FACES 7
#define RADIVOX_SKIP kSkipBricks
#define RADIVOX_HIT kHit
#define RADIVOX_BIND_PLANE_EXTRAS 8
#define RADIVOX_VOXEL_COUNT voxelCount
struct RayEnd {
  vec3 direction;  // unit
  float time;      // voxels
  uint hit;        // face, or kHitBack, or kHitNothing
  uint cluster;    // of the face
};
layout(set = 0, binding = 9, scalar) readonly buffer Directions { uint directions[]; };
layout(set = 0, binding = 10, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 11, scalar) writeonly buffer Ends { RayEnd ends[]; };
layout(push_constant, scalar) uniform Push {
  uint faceId;
  uint rayCount;
  uint voxelCount;
};
#include "shared/dispatch.glsl"
#include "shared/voxel_cast.glsl"

void main() {
  castBegin();
  uint ray = radivoxItemIndex();
  if (ray >= rayCount) return;
  Face face = faceAt(faceId);
  uint packed = packedVoxel(face.key >> 3);
  uvec3 coordinate = unpackVoxel(packed);
  uint seed = faceSeed(packed, face.key & 7u);
  vec3 position = facePosition(face, coordinate);
  vec3 n = decodeNormal(face.normal);
  vec3 origin = liftedOrigin(position, n);
  ivec3 start = clamp(ivec3(floor(origin)), ivec3(0), ivec3(castSize) - 1);
  uint excluded = 0x3fu;
  bool crowded = false;
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
  TraversalRay way = makeTraversalRay(origin, alongNormal(decodeDirection(directions[shiftOf(seed) * rayCount + ray]), n));
  TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
  uint inFront = 0u;
  bool fresh = true;
  uint hit;
  do {
    if (!fresh || !(crowded || kFrame == 1)) traversalStep(way, cursor);
    bool atStart = fresh && crowded;
    uint voxel;
    if (castMarch(way, cursor, !atStart, voxel)) inFront = 0u;
    hit = castFace(way, cursor, voxel, atStart ? excluded : 0u, inFront, rayRandom(seed, ray));
    fresh = false;
  } while (!isOutside(cursor.voxel) && hit == kHitNothing);
  uint cluster = hit < kHitBack ? labels[hit] : kNone;
  ends[ray] = RayEnd(way.direction, cursor.time, hit, cluster);
}
