// A ray that sees triangles in its first voxels and planes beyond them. Over shared/voxel_cast.glsl and shared/voxel_triangles.glsl, whose
// declarations the includer makes.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_WALK_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_WALK_GLSL
#include "shared/voxel_cast.glsl"
#include "shared/voxel_triangles.glsl"

// The face of `voxel` that stands for surface with unit normal n: the one that it belongs to; where surface is projected, or that one is missing, drawn
// with probability n_k²: a face of another axis is mostly other surface's. kHitBack: it has none. `apart`: faces that the surface is no part of, unless
// it has no others.
uint faceTowards(uint voxel, vec3 n, uint apart, uint random) {
  uint mask = planeAt(voxel).x >> 26;
  uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(lessThan(n, vec3(0.0)));
  precise vec3 squares = n * n;
  uint kept = mask & ~apart;
  precise vec3 w = (castDominant ? faceShares(n, true) : squares) * vec3((kept >> facing.x) & 1u, (kept >> facing.y) & 1u, (kept >> facing.z) & 1u);
  if (w.x + w.y + w.z == 0.0) w = squares * vec3((mask >> facing.x) & 1u, (mask >> facing.y) & 1u, (mask >> facing.z) & 1u);
  precise float two = w.x + w.y;
  precise float total = two + w.z;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  uint f = draw < w.x ? facing.x : (draw >= two && w.z > 0.0 ? facing.z : (w.y > 0.0 ? facing.y : facing.x));
  uint face = castFirst(voxel) + uint(bitCount(mask & ((1u << f) - 1u)));
  return total > 0.0 ? face : kHitBack;
}

struct WalkHit {
  uint face;      // kHitNothing: the ray left the grid; kHitBack
  float time;     // voxels
  uint triangle;  // kNone: stopped by a plane
  vec3 normal;    // of the triangle, unit, on the side that the ray sees
};

WalkHit hitOfTriangle(TraversalRay way, uint triangle, vec2 time) {
  vec3 normal = cornerNormal(triangle);
  precise float at = time.x * preciseReciprocal(time.y);
  return WalkHit(kHitNothing, at, triangle, triangleDot(normal, way.direction) > 0.0 ? -normal : normal);
}

// The same hit again, from its face and triangle. Where it has no triangle, its time is not known.
WalkHit keptHit(TraversalRay way, uvec2 kept) {
  WalkHit hit = WalkHit(kHitNothing, 0.0, kNone, vec3(0.0));
  if (kept.y != kNone) {
    vec2 time;
    meetsTriangle(way, kept.y, 0.0, vec2(0.0, 1.0), time);
    hit = hitOfTriangle(way, kept.y, time);
  }
  hit.face = kept.x;
  return hit;
}

// Voxels are searched for triangles while the ray enters them before `nearDistance`; beyond, and from the first voxel on whose list is empty (too many
// triangles), its planes count, without `excluded` ones in the first voxel. A plane that is met from behind counts where one of the voxel's triangles is
// met, and as that triangle; else the ray goes on. (In Sponza, N = 128, one ray in a hundred met such a plane, and hardly any a back: what
// the others ended on was dark, and indirect light 0.989 of the truth instead of 1.003.) `own`: the triangle that the ray starts from, `lift` (voxels) off it.
// `startList`: entries of the first voxel's list that its ray may meet, so that rays from one point leave out the others once (all: kWholeList).
//
// CPU devices execute both sides of every branch, for all lanes: what a ray needs once is not in the loops.
const uvec2 kWholeList = uvec2(0u, 0xffffffffu);

WalkHit walkRay(TraversalRay way, ivec3 start, uint excluded, uvec2 startList, uint own, float lift, float nearDistance, uint random) {
  WalkHit result = WalkHit(kHitNothing, 0.0, kNone, vec3(0.0));
  TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
  bool atStart = true;
  TraversalCursor last = cursor;  // the voxel before, if it was searched for triangles and the ray stepped out of it
  uint lastVoxel = 0u;
  bool hasLast = false;
  bool met = false;
  uint voxel = 0u, listed = 0u;
  vec2 time = vec2(0.0, 1.0);
  while (nearDistance > 0.0) {
    if (castMarch(way, cursor, true, voxel)) atStart = hasLast = false;
    if (voxel == kNone || cursor.time >= nearDistance) break;
    uint first = triangleFirst(voxel), end = triangleFirst(voxel + 1u);
    if (first == end) break;
    if (atStart) {
      first = max(first, startList.x);
      end = min(end, startList.y);
    }
    met = nearestTriangle(way, cursor, first, end, own, lift, time, listed);
    if (met) break;
    last = cursor;
    lastVoxel = voxel;
    hasLast = true;
    traversalStep(way, cursor);
    atStart = false;
  }
  // A surface that bends passes between the planes of two voxels. Where the first of them was searched for triangles and none was met, the ray is in
  // front of whatever its planes say it has crossed.
  uint inFront = 0u;
  if (!met && hasLast) {
    PlaneHit crossed = castPlane(way, last, lastVoxel, 0u, inFront);
    if (crossed.faces != 0u) inFront = 0x3fu;
  }
  PlaneHit plane = PlaneHit(0u, 0u, 0u, false, vec3(0.0));
  bool goesOn = !met;
  while (goesOn) {
    while (true) {
      uint crossed;
      if (castMarch(way, cursor, true, crossed)) {
        inFront = 0u;
        atStart = false;
      }
      plane.faces = 0u;
      if (crossed == kNone) break;
      plane = castPlane(way, cursor, crossed, atStart ? excluded : 0u, inFront);
      if (plane.faces != 0u) break;
      traversalStep(way, cursor);
      atStart = false;
    }
    // Planes reach beyond the edges of their surface, and what is met there from behind is seldom a back: the triangles tell.
    bool doubtful = plane.faces != 0u && plane.behind && nearDistance > 0.0;
    uint first = doubtful ? triangleFirst(plane.voxel) : 0u, end = doubtful ? triangleFirst(plane.voxel + 1u) : 0u;
    goesOn = first != end;
    if (goesOn) {
      // From the origin on: planes are rounded, and a ray that hardly leaves its surface may have met the triangle in the voxel before.
      met = nearestTriangle(way, TraversalCursor(cursor.voxel, 0.0), first, end, own, lift, time, listed);
      voxel = plane.voxel;
      goesOn = !met;
      plane.faces = 0u;
      if (goesOn) traversalStep(way, cursor);
      atStart = false;
      inFront = 0x3fu;  // of what it has not met; the next voxel may hold it
    }
  }
  result.face = faceOfPlane(way, plane, random);
  result.time = cursor.time;
  if (met) {
    result = hitOfTriangle(way, listedTriangle(listed), time);
    result.face = faceTowards(voxel, result.normal, listedApart(listed), random);
  }
  return result;
}

#endif
