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
#include "shared/voxel_cast.glsl"
layout(constant_id = 3) const bool kNear = false;    // the first voxels of a ray are tested by their triangles
layout(constant_id = 4) const bool kMasked = false;  // some material has an alpha mask
#include "shared/scene.h"
layout(set = 0, binding = 13, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 14, scalar) readonly buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 15, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 16, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 17, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 18, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 19, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 20, scalar) readonly buffer Pieces { uvec2 pieces[]; };
#include "shared/voxel_triangles.glsl"

// What piece of its surface a ray of the face starts from.
struct Start {
  vec3 origin;
  vec3 normal;
  uint triangle;
};

float pieceWeight(uint entry, uint f, bool backs, out vec3 n) {
  uint id = triangleIds[entry];
  vec3 a = vertices[indices[3u * id]].position;
  vec3 e1 = vertices[indices[3u * id + 1u]].position - a;
  vec3 e2 = vertices[indices[3u * id + 2u]].position - a;
  precise vec3 across = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
  precise float squared = triangleDot(across, across);
  n = across * preciseInverseSqrt(max(squared, 1e-30));
  if (backs) n = -n;
  uvec2 piece = pieces[entry];
  float seen = float((backs ? piece.y >> 24 : piece.y >> 16) & 255u);
  float along = (f & 1u) != 0u ? -n[f >> 1] : n[f >> 1];
  return max(along, 0.0) * unpackHalf2x16(piece.y).x * max(seen, 1.0 / 16.0);
}

// The face of `voxel` that stands for surface with this normal, drawn with probability n_k²: a face of another axis is mostly other surface's.
// kHitBack: it has none.
uint faceTowards(uint voxel, vec3 n, uint random) {
  uint mask = planes[voxel].x >> 26;
  uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(lessThan(n, vec3(0.0)));
  precise vec3 w = n * n * vec3((mask >> facing.x) & 1u, (mask >> facing.y) & 1u, (mask >> facing.z) & 1u);
  precise float two = w.x + w.y;
  precise float total = two + w.z;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  uint f = draw < w.x ? facing.x : (draw >= two && w.z > 0.0 ? facing.z : (w.y > 0.0 ? facing.y : facing.x));
  uint face = castFirst[voxel] + uint(bitCount(mask & ((1u << f) - 1u)));
  return total > 0.0 ? face : kHitBack;
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
    uint ownVoxel = face.key >> 3;
    uint f = face.key & 7u;
    uint firstEntry = triangleFirst[ownVoxel];
    uint endEntry = triangleFirst[ownVoxel + 1u];
    float total = 0.0;
    bool backs = false;
    vec3 pn;
    for (uint e = firstEntry; e < endEntry; ++e) total += pieceWeight(e, f, false, pn);
    if (total == 0.0) {
      backs = true;
      for (uint e = firstEntry; e < endEntry; ++e) total += pieceWeight(e, f, true, pn);
    }
    uint turn = hashBits(s ^ 0x51ed270bu);
    ivec3 meanStart = start;
    for (; subgroupAny(ray < end); ++ray) {
      bool busy = ray < end;
      uint at = busy ? ray : max(ray, 1u) - 1u;
      vec3 from = origin;
      vec3 about = n;
      uint own = kNone;
      start = meanStart;
      if (total > 0.0) {
        // Strata of the pieces' weights, in an order that has nothing to do with that of the directions.
        float stratum = (float((at * 11u + turn) % rayCount) + 0.5) / float(rayCount) * total;
        uint chosen = firstEntry;
        for (uint e = firstEntry; e < endEntry; ++e) {
          float w = pieceWeight(e, f, backs, pn);
          if (w > 0.0 && stratum >= 0.0) {
            chosen = e;
            about = pn;
          }
          stratum -= w;
          if (stratum < 0.0) break;
        }
        own = triangleIds[chosen];
        from = vec3(coordinate) + decodePosition(pieces[chosen].x) + 2e-3 * about;
        start = clamp(ivec3(floor(from)), ivec3(0), ivec3(castSize) - 1);
      }
      TraversalRay way = makeTraversalRay(from, alongNormal(decodeDirection(directions[table + at]), about));
      TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
      uint random = rayRandom(s, at);
      uint hit = kHitNothing;
      bool atStart = true;
      bool looking = busy;
      bool going = busy;
      while (subgroupAny(looking)) {
        if (castMarch(way, cursor, looking)) atStart = false;
        bool outside = isOutside(cursor.voxel);
        looking = looking && !outside && cursor.time < triangleDistance;
        uint voxel = looking ? voxelIndex(ivec3(cursor.voxel)) : 0u;
        looking = looking && voxel != kNone;
        voxel = looking ? voxel : 0u;
        float time;
        vec3 normal;
        uint triangle;
        if (nearestTriangle(way, cursor, looking, voxel, own, time, normal, triangle)) {
          hit = faceTowards(voxel, normal, random);
          cursor.time = time;
          looking = going = false;
        }
        bool noList = looking && triangleFirst[voxel] == triangleFirst[voxel + 1u];
        if (subgroupAny(noList)) {
          uint none = 0u;
          uint found = castFace(way, cursor, noList, atStart ? excluded : 0u, none, random);
          if (found != kHitNothing) {
            hit = found;
            looking = going = false;
          }
        }
        TraversalCursor stepped = cursor;
        traversalStep(way, stepped);
        cursor.voxel = mix(cursor.voxel, stepped.voxel, bvec3(looking));
        cursor.time = looking ? stepped.time : cursor.time;
        atStart = atStart && !looking;
      }
      uint inFront = 0u;
      while (subgroupAny(going)) {
        if (castMarch(way, cursor, going)) inFront = 0u;
        going = going && !isOutside(cursor.voxel);
        uint found = castFace(way, cursor, going, 0u, inFront, random);
        hit = going ? found : hit;
        going = going && found == kHitNothing;
        TraversalCursor stepped = cursor;
        traversalStep(way, stepped);
        cursor.voxel = mix(cursor.voxel, stepped.voxel, bvec3(going));
        cursor.time = going ? stepped.time : cursor.time;
      }
      uint result = hit | (cursor.time <= nearDistance ? kNearHit : 0u) | (cursor.time <= kCloseDistance ? kCloseHit : 0u);
      result = hit == kHitBack ? kMissHit + 6u : result;
      result = hit == kHitNothing ? kMissHit + directionBin(way.direction) : result;
      if (!idle && busy) hits[row * rayCount + at] = result;
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
    uint result = hit | (cursor.time <= nearDistance ? kNearHit : 0u) | (cursor.time <= kCloseDistance ? kCloseHit : 0u);
    result = hit == kHitBack ? kMissHit + 6u : result;
    result = outside ? kMissHit + directionBin(way.direction) : result;
    // Written in every pass: overwritten until the ray is done, and again as it was once all are.
    last = busy ? result : last;
    if (!idle) hits[row * rayCount + at] = last;
    ray += fresh && busy ? 1u : 0u;
  }
}
