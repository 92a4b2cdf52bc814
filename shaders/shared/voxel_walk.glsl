// A ray that sees triangles in its first voxels and planes beyond them. Over shared/voxel_cast.glsl and shared/voxel_triangles.glsl, whose
// declarations the includer makes.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_WALK_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_WALK_GLSL
#include "shared/voxel_cast.glsl"
#include "shared/voxel_triangles.glsl"

// The face of `voxel` that stands for surface with unit normal n, drawn with probability n_k²: a face of another axis is mostly other surface's.
// kHitBack: it has none. `apart`: faces that the surface is no part of, unless it has no others.
uint faceTowards(uint voxel, vec3 n, uint apart, uint random) {
  uint mask = planes[voxel].x >> 26;
  uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(lessThan(n, vec3(0.0)));
  precise vec3 squares = n * n;
  uint kept = mask & ~apart;
  precise vec3 w = squares * vec3((kept >> facing.x) & 1u, (kept >> facing.y) & 1u, (kept >> facing.z) & 1u);
  if (w.x + w.y + w.z == 0.0) w = squares * vec3((mask >> facing.x) & 1u, (mask >> facing.y) & 1u, (mask >> facing.z) & 1u);
  precise float two = w.x + w.y;
  precise float total = two + w.z;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  uint f = draw < w.x ? facing.x : (draw >= two && w.z > 0.0 ? facing.z : (w.y > 0.0 ? facing.y : facing.x));
  uint face = castFirst[voxel] + uint(bitCount(mask & ((1u << f) - 1u)));
  return total > 0.0 ? face : kHitBack;
}

struct WalkHit {
  uint face;      // kHitNothing: the ray left the grid; kHitBack
  float time;     // voxels
  uint triangle;  // kNone: stopped by a plane
  vec3 normal;    // of the triangle, unit, on the side that the ray sees
};

// Voxels are searched for triangles while the ray enters them before `nearDistance`; beyond, and where a voxel's list is empty (too many triangles),
// its planes count, without `excluded` ones in the first voxel. `own`: the triangle that the ray starts from, `lift` (voxels) off it. Lanes stay together; all must call.
WalkHit walkRay(TraversalRay way, ivec3 start, uint excluded, uint own, float lift, float nearDistance, uint random,
                bool live) {
  WalkHit result = WalkHit(kHitNothing, 0.0, kNone, vec3(0.0));
  TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
  bool atStart = true;
  bool looking = live && nearDistance > 0.0;
  bool going = live;
  TraversalCursor last = cursor;  // the voxel before, if it was searched for triangles and the ray stepped out of it
  bool hasLast = false;
  while (subgroupAny(looking)) {
    if (castMarch(way, cursor, looking)) atStart = hasLast = false;
    looking = looking && !isOutside(cursor.voxel) && cursor.time < nearDistance;
    uint voxel = looking ? voxelIndex(ivec3(cursor.voxel)) : 0u;
    looking = looking && voxel != kNone;
    voxel = looking ? voxel : 0u;
    float time;
    vec3 normal;
    uint triangle, apart;
    if (nearestTriangle(way, cursor, looking, voxel, own, lift, time, normal, triangle, apart)) {
      precise vec3 unit = normal * preciseInverseSqrt(max(triangleDot(normal, normal), 1e-30));
      result = WalkHit(faceTowards(voxel, unit, apart, random), time, triangle, unit);
      looking = going = false;
    }
    bool noList = looking && triangleFirst[voxel] == triangleFirst[voxel + 1u];
    if (subgroupAny(noList)) {
      uint inFront = 0u;
      uint found = castFace(way, cursor, noList, atStart ? excluded : 0u, inFront, random);
      if (found != kHitNothing) {
        result.face = found;
        result.time = cursor.time;
        looking = going = false;
      }
    }
    if (looking) {
      last = cursor;
      hasLast = true;
    }
    TraversalCursor stepped = cursor;
    traversalStep(way, stepped);
    cursor.voxel = mix(cursor.voxel, stepped.voxel, bvec3(looking));
    cursor.time = looking ? stepped.time : cursor.time;
    atStart = atStart && !looking;
  }
  // A surface that bends passes between the planes of two voxels. Where the first of them was searched for triangles and none was met, the ray is in
  // front of whatever its planes say it has crossed.
  uint inFront = 0u;
  if (subgroupAny(going && hasLast)) {
    uint crossed = castFace(way, last, going && hasLast, 0u, inFront, random);
    inFront = going && hasLast ? (crossed == kHitNothing ? inFront : 0x3fu) : 0u;
  }
  while (subgroupAny(going)) {
    if (castMarch(way, cursor, going)) {
      inFront = 0u;
      atStart = false;
    }
    going = going && !isOutside(cursor.voxel);
    uint found = castFace(way, cursor, going, atStart ? excluded : 0u, inFront, random);
    result.face = going ? found : result.face;
    result.time = going ? cursor.time : result.time;
    going = going && found == kHitNothing;
    TraversalCursor stepped = cursor;
    traversalStep(way, stepped);
    cursor.voxel = mix(cursor.voxel, stepped.voxel, bvec3(going));
    cursor.time = going ? stepped.time : cursor.time;
    atStart = false;
  }
  return result;
}

#endif
