// What a ray sees in the voxel grid: the first voxel face that it crosses. Over shared/voxel_march.glsl;
// tests/oracles/traversal_oracle.h says the same on the CPU.
//
// Before including, bind what shared/voxel_march.glsl asks for, RADIVOX_BIND_CAST_FIRST (faces first), RADIVOX_BIND_PLANES and
// RADIVOX_BIND_PLANE_EXTRAS (shared/voxel_plane.h); define RADIVOX_VOXEL_COUNT (V), RADIVOX_SKIP and RADIVOX_HIT (a constant of the values below). Call
// castBegin() first.
//
// Which face is hit (kHitPlane). Taking every occupied voxel for a wall stops rays on the next step of the very surface they leave;
// lifting origins off the surface puts some into the next room. So the faces of a voxel stand for planes: those whose mean
// planes agree (within 8° and 0.05 voxels of the largest's) for one, through its mean point x with its mean normal n. A ray
// hits a plane when, inside the voxel,
//   (1) it passes from one side to the other; or was on the near side of a plane of the voxel before that looks along the same
//       axis and is behind this one (a surface that bends passes between two planes otherwise);
//   (2) it does so where the surface is: no farther than kMarginSlack into faceMargins of the largest face;
// and has faces on it that see the ray: e_f·n of the near side's sign, and where surface is projected (Grid::dominant is 0) e_f·d < 0. Of several planes
// the first counts; of its faces one is drawn with probability ∝ |n_k d_k|, which is a_f |d·e_f| for a plane (∝ |n_k|: where surface belongs to one
// face there seldom is another). A plane met from behind has none that shows a front: planes reach a little beyond a solid's edges. Then it is the
// voxel's faces which look the ray's way, whatever their plane, those made of backs too; and where there are none, the back of a one-sided surface, which
// absorbs. PlaneHit::behind says so, since most are no backs (shared/voxel_walk.glsl asks the triangles). In the voxel of the origin, planes through
// its own surface do not count.
// kHitVoxel is the paper's: any voxel with a face that looks at the ray stops it.
//
// Measured against exact rays on Sponza (N = 128, all faces, weight a_s): RMSE of the missed share 0.013 (kHitVoxel lifted
// by 1.5 h: 0.018 to 0.053, not lifted: 0.23), mean error of E 36 % (50 %, 270 %); leaks of a closed room below 2e-4 of the rays.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_CAST_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_CAST_GLSL
#include "shared/face_shares.h"
#include "shared/voxel_march.glsl"
#include "shared/voxel_plane.h"

const uint kHitPlane = 0u;
const uint kHitVoxel = 1u;

const float kOwnPlaneDistance = 0.25;  // voxels
const float kOwnPlaneCosine = 0.82;    // 35°
const float kMarginSlack = 0.02;    // voxels
const float kInFront = -1e-3;          // behind a plane by this still counts as in front of it, for the next voxel (voxels / √3 to 1)

const uint kHitNothing = kNone;           // face: the ray left the grid
const uint kHitBack = kNone - 1u;         // face: stopped by the back of a one-sided surface

// Words as texels: what lanes load from scattered places, CPU devices fetch for all lanes at once from these, and lane by lane from storage buffers.
layout(set = 0, binding = RADIVOX_BIND_PLANES) uniform usamplerBuffer planeTexels;
layout(set = 0, binding = RADIVOX_BIND_PLANE_EXTRAS) uniform usamplerBuffer planeExtraTexels;
layout(set = 0, binding = RADIVOX_BIND_CAST_FIRST) uniform usamplerBuffer castFirstTexels;
uvec2 planeAt(uint i) { return uvec2(texelFetch(planeTexels, int(2u * i)).x, texelFetch(planeTexels, int(2u * i + 1u)).x); }
uint castFirst(uint voxel) { return texelFetch(castFirstTexels, int(voxel)).x; }

float castDot(vec3 a, vec3 b) {
  precise float sum = a.x * b.x + a.y * b.y;
  precise float all_ = sum + a.z * b.z;
  return all_;
}

// The plane after plane `i` of a voxel, counted from 0.
uvec2 nextPlane(uint voxel, uint i) { return planeAt(RADIVOX_VOXEL_COUNT + texelFetch(planeExtraTexels, int(voxel)).x + i); }

// The planes of `voxel` that lie on the plane of a point, bit by bit in their order, and whether there are others.
uint ownPlanes(uint voxel, uvec3 coordinate, vec3 position, vec3 normal, out bool crowded) {
  uint own = 0u;
  crowded = false;
  uvec2 plane = planeAt(voxel);
  if (plane.x >> 26 == 0u) return own;
  for (uint i = 0u; i < kFaceCount; ++i) {
    vec3 n = planeNormal(plane.x);
    // n is no unit vector: compare squares.
    precise float distance_ = castDot(position - vec3(coordinate), n) - planeOffset(plane.y);
    precise float most = kOwnPlaneDistance * kOwnPlaneDistance * castDot(n, n);
    float along = castDot(n, normal);
    precise float least = kOwnPlaneCosine * kOwnPlaneCosine * castDot(n, n);
    precise float square = along * along;
    precise float offset = distance_ * distance_;
    bool isOwn = offset < most && square > least;
    own |= isOwn ? 1u << i : 0u;
    crowded = crowded || !isOwn;
    if ((plane.y & kPlaneMore) == 0u) break;
    plane = nextPlane(voxel, i);
  }
  return own;
}

// What a ray meets of a voxel's planes.
struct PlaneHit {
  uint voxel;
  uint mask;    // faces of the voxel
  uint faces;   // those that the ray may hit, and << 8 the directions from which it sees the plane; 0: it meets none
  bool behind;  // no surface shows its front on the side that the ray sees
  vec3 normal;  // of the plane, on the side that the ray sees; |x| + |y| + |z| = 1
};

// The first plane of the cursor's voxel, which is `voxel`, that the ray meets before it leaves it; none where that is kNone. Planes in `excluded` do not
// count. `inFront` carries rule (1) from voxel to voxel: 0 where the voxel before had no faces.
PlaneHit castPlane(TraversalRay ray, TraversalCursor cursor, uint voxel, uint excluded, inout uint inFront) {
  uint wasInFront = inFront;
  inFront = 0u;
  bool exists = voxel != kNone;
  voxel = exists ? voxel : 0u;
  uvec2 plane = planeAt(voxel);
  uint mask = plane.x >> 26;
  vec3 exits = traversalExits(ray, cursor.voxel);
  float exit = min(exits.x, min(exits.y, exits.z));
  // Surface that belongs to one face has it whatever the ray's way.
  float leastSeen = castDominant ? 2.0 : 0.0;
  precise vec3 enterPoint = ray.origin + cursor.time * ray.direction;
  precise vec3 passage = (ray.origin + exit * ray.direction) - enterPoint;

  // The first plane that is crossed: `before` of `whole` of the passage lies in front of it.
  float bestBefore = 2.0;
  float bestWhole = 1.0;
  vec3 bestNormal = vec3(0.0);
  uint bestFaces = 0u;
  bool bestBehind = false;
  bool more = exists && mask != 0u;
  for (uint i = 0u; more; ++i) {
    vec3 n = planeNormal(plane.x);
    bool counts = ((excluded >> i) & 1u) == 0u;
    float slope = castDot(ray.direction, n);
    float side = slope > 0.0 ? -1.0 : 1.0;
    n = n * side;
    // Directions in which the near side looks (and where surface is projected, at the ray) and has faces, or whose backs it has.
    uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(lessThan(n, vec3(0.0)));
    bvec3 seen = lessThan(n * ray.direction, vec3(leastSeen));
    uint looks = (seen.x ? 1u << facing.x : 0u) | (seen.y ? 1u << facing.y : 0u) | (seen.z ? 1u << facing.z : 0u);
    uint members = (plane.x >> 20) & 63u;
    looks &= members | (members & 21u) << 1 | ((members >> 1) & 21u);
    bool hits = counts && looks != 0u;
    float before = 0.0;
    float whole = 1.0;
    if (RADIVOX_HIT == kHitPlane) {
      precise vec3 entry = enterPoint - cursor.voxel;
      float offset = planeOffset(plane.y) * side;
      precise float start = castDot(entry, n) - offset;
      precise float after = castDot(entry + passage, n) - offset;
      before = start;
      hits = hits && after <= 0.0 && (before >= 0.0 || (wasInFront & looks) != 0u);
      inFront |= counts && after >= kInFront ? looks : 0u;
      before = max(before, 0.0);
      precise float both = before - after;
      whole = both;
      // Both sides times before − after: no division.
      precise vec3 crossing = entry * whole + passage * before;
      uint axis = planeAxis(plane.y);
      vec2 across = axis == 0u ? crossing.yz : (axis == 1u ? crossing.zx : crossing.xy);
      uint margins = planeMargins(plane.y);
      vec2 low = vec2(margins & 15u, (margins >> 8) & 15u), high = vec2((margins >> 4) & 15u, margins >> 12);
      precise vec2 least = (low * (1.0 / 16.0) - kMarginSlack) * whole;
      precise vec2 most = ((1.0 + kMarginSlack) - high * (1.0 / 16.0)) * whole;
      hits = hits && all(greaterThanEqual(across, least)) && all(lessThanEqual(across, most));
    }
    precise float left = before * bestWhole;
    precise float right = bestBefore * whole;
    if (hits && left < right) {
      bestBefore = before;
      bestWhole = whole;
      bestNormal = n;
      uint seen_ = (looks & members) != 0u ? looks & members : looks & mask;
      bestFaces = looks << 8 | seen_;
      bestBehind = (looks & members) == 0u;
    }
    more = (plane.y & kPlaneMore) != 0u;
    if (more) plane = nextPlane(voxel, i);
  }
  return PlaneHit(voxel, mask, bestFaces, bestBehind, bestNormal);
}

// The face that a ray hits of the plane that it meets; kHitNothing: it meets none; kHitBack. `random` is uniform.
uint faceOfPlane(TraversalRay ray, PlaneHit hit, uint random) {
  uvec3 facing = uvec3(0u, 2u, 4u) + uvec3(lessThan(hit.normal, vec3(0.0)));
  precise vec3 weight = abs(hit.normal * (castDominant ? vec3(1.0) : ray.direction));
  vec3 w = vec3((hit.faces >> facing.x) & 1u, (hit.faces >> facing.y) & 1u, (hit.faces >> facing.z) & 1u) * weight;
  precise float two = w.x + w.y;
  precise float total = two + w.z;
  precise float draw = float(random >> 8) * (1.0 / 16777216.0) * total;
  uint f = draw < w.x ? facing.x : (draw >= two && w.z > 0.0 ? facing.z : (w.y > 0.0 ? facing.y : facing.x));
  uint face = castFirst(hit.voxel) + uint(bitCount(hit.mask & ((1u << f) - 1u)));
  return hit.faces == 0u ? kHitNothing : (total > 0.0 ? face : kHitBack);
}

uint castFace(TraversalRay ray, TraversalCursor cursor, uint voxel, uint excluded, inout uint inFront, uint random) {
  return faceOfPlane(ray, castPlane(ray, cursor, voxel, excluded, inFront), random);
}

#endif
