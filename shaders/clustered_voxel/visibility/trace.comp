#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
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
  float triangleDistance;  // voxels; up to here rays meet triangles
};
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/voxel_cast.glsl"
layout(constant_id = 3) const bool kNear = false;    // rays start on pieces of surface, and test triangles in their first voxels
layout(constant_id = 4) const bool kMasked = false;  // some material has an alpha mask
layout(set = 0, binding = 13, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 14, scalar) readonly buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 15, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 16, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 17, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 18, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 19, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 20, scalar) readonly buffer Pieces { uvec2 pieces[]; };  // middle, area (clustered_voxel.triangles)
#include "shared/voxel_walk.glsl"

const float kPieceLift = 2e-3;  // voxels: pieces' middles are good to 1e-3

// What a listed triangle's piece gives to face f of its voxel: area · |n·e_f| if its front looks that way (`backs`: its back); n: that side's normal.
float pieceWeight(uint entry, uint f, bool backs, out vec3 n) {
  uint id = triangleIds[entry];
  vec3 a = vertices[indices[3u * id]].position;
  vec3 e1 = vertices[indices[3u * id + 1u]].position - a;
  vec3 e2 = vertices[indices[3u * id + 2u]].position - a;
  precise vec3 across = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
  precise float squared = triangleDot(across, across);
  precise vec3 unit = across * (preciseInverseSqrt(max(squared, 1e-30)) * (backs ? -1.0 : 1.0));
  n = unit;
  precise float weight = max((f & 1u) != 0u ? -unit[f >> 1] : unit[f >> 1], 0.0) * uintBitsToFloat(pieces[entry].y);
  return weight;
}

// The pieces of a face's surface, as rays start from them: fronts, or backs where there are no fronts (as clustered_voxel.surface makes faces).
struct Surface {
  uint first;
  uint end;
  bool backs;
  float total;  // of the weights; 0: no list
};

Surface surfaceOf(uint voxel, uint f) {
  Surface surface = Surface(triangleFirst[voxel], triangleFirst[voxel + 1u], false, 0.0);
  vec3 n;
  for (uint e = surface.first; e < surface.end; ++e) surface.total += pieceWeight(e, f, false, n);
  if (surface.total > 0.0) return surface;
  surface.backs = true;
  for (uint e = surface.first; e < surface.end; ++e) surface.total += pieceWeight(e, f, true, n);
  return surface;
}

// The entry whose share of the weights holds `at` in [0, 1).
uint pieceAt(Surface surface, uint f, float at, out vec3 normal) {
  float left = at * surface.total;
  uint chosen = surface.first;
  normal = vec3(0.0, 0.0, 1.0);
  for (uint e = surface.first; e < surface.end; ++e) {
    vec3 n;
    float weight = pieceWeight(e, f, surface.backs, n);
    if (weight > 0.0 && left >= 0.0) {
      chosen = e;
      normal = n;
    }
    left -= weight;
    if (left < 0.0) break;
  }
  return chosen;
}

uint hitWord(uint face, float time, vec3 direction) {
  if (face == kHitNothing) return kMissHit + directionBin(direction);
  if (face == kHitBack) return kMissHit + 6u;
  return face | (time <= nearDistance ? kNearHit : 0u) | (time <= kCloseDistance ? kCloseHit : 0u);
}

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

  if (kNear) {
    uint f = face.key & 7u;
    Surface surface = surfaceOf(face.key >> 3, f);
    uint turn = hashBits(s ^ 0x51ed270bu);
    for (; subgroupAny(ray < end); ++ray) {
      uint at = min(ray, rayCount - 1u);
      vec3 from = origin;
      vec3 about = n;
      uint own = kNone;
      if (surface.total > 0.0) {
        // Strata of the surface, in an order that has nothing to do with that of the directions.
        uint entry = pieceAt(surface, f, (float((at * 11u + turn) % rayCount) + 0.5) / float(rayCount), about);
        own = triangleIds[entry];
        from = vec3(coordinate) + decodePosition(pieces[entry].x) + kPieceLift * about;
      }
      TraversalRay way = makeTraversalRay(from, alongNormal(decodeDirection(directions[table + at]), about));
      ivec3 first = clamp(ivec3(floor(from)), ivec3(0), ivec3(castSize) - 1);
      WalkHit hit = walkRay(way, first, excluded, own, kPieceLift, triangleDistance, rayRandom(s, at), ray < end);
      if (!idle && ray < end) hits[row * rayCount + at] = hitWord(hit.face, hit.time, way.direction);
    }
    return;
  }

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
    uint result = hitWord(outside ? kHitNothing : hit, cursor.time, way.direction);
    // Written in every pass: overwritten until the ray is done, and again as it was once all are.
    last = busy ? result : last;
    if (!idle) hits[row * rayCount + at] = last;
    ray += fresh && busy ? 1u : 0u;
  }
}
