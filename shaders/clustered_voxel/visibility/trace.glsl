// What the shaders that cast the rays of voxel faces share: bindings, push constants, and where rays start. `trace.comp` counts what the rays hit;
// `bench.comp` casts them one by one, for measuring. Before including: the extensions of shared/texture.glsl, and visibility.h;
// what push constants go on with may be defined as RADIVOX_TRACE_MORE.
#ifndef RADIVOX_CLUSTERED_VOXEL_VISIBILITY_TRACE_GLSL
#define RADIVOX_CLUSTERED_VOXEL_VISIBILITY_TRACE_GLSL
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
layout(push_constant, scalar) uniform Push {
  uint firstFace;  // of the chunk
  uint rowCount;
  uint rayCount;
  float nearDistance;  // voxels; hits up to here keep their face
  uint voxelCount;
  float triangleDistance;  // voxels; up to here rays meet triangles
#ifdef RADIVOX_TRACE_MORE
  RADIVOX_TRACE_MORE
#endif
};
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/voxel_cast.glsl"
layout(constant_id = 3) const bool kNear = false;    // rays start on pieces of surface, and test triangles in their first voxels
layout(constant_id = 4) const bool kMasked = false;  // some material has an alpha mask
layout(set = 0, binding = 13) uniform usamplerBuffer triangleFirstTexels;
layout(set = 0, binding = 14) uniform usamplerBuffer triangleIdTexels;
layout(set = 0, binding = 15, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 16, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 17, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 18, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 19, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 20) uniform usamplerBuffer pieceTexels;  // two words each: middle, area (clustered_voxel.triangles)
layout(constant_id = 6) const bool kCorners = false;  // triangleCorners is there
layout(set = 0, binding = 21) uniform isamplerBuffer triangleCorners;
#include "shared/voxel_walk.glsl"

const float kPieceLift = 2e-3;  // voxels: pieces' middles are good to 1e-3

// What a listed triangle's piece gives to face f of its voxel: its share of the area if its front looks that way (`backs`: its back) and is part of the face; n:
// that side's normal.
float pieceWeight(uint entry, uint f, bool backs, out vec3 n) {
  uint listed = triangleIds(entry);
  vec3 front = cornerNormal(listedTriangle(listed));
  vec3 unit = backs ? -front : front;
  n = unit;
  bool looks = ((f & 1u) != 0u ? -unit[f >> 1] : unit[f >> 1]) > 0.0;
  precise float share = faceShares(unit, castDominant)[f >> 1] * uintBitsToFloat(texelFetch(pieceTexels, int(2u * entry + 1u)).x);
  float weight = looks ? share : 0.0;
  return ((listedApart(listed) >> f) & 1u) != 0u ? 0.0 : weight;
}

// The pieces of a face's surface, as rays start from them: fronts, or backs where there are no fronts (as clustered_voxel.surface makes faces).
struct Surface {
  uint first;
  uint end;
  bool backs;
  float total;  // of the weights; 0: no list
};

Surface surfaceOf(uint voxel, uint f) {
  Surface surface = Surface(triangleFirst(voxel), triangleFirst(voxel + 1u), false, 0.0);
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

// The voxel of a point; beyond the border, the nearest.
ivec3 voxelAt(vec3 p) { return clamp(ivec3(floor(p)), ivec3(0), ivec3(castSize) - 1); }

// A face as its rays start from it.
struct Start {
  uint seed;         // faceSeed
  uint f;            // which way it looks
  uvec3 coordinate;  // of its voxel
  vec3 origin;       // of rays that do not start on pieces
  vec3 normal;       // about which they go
  ivec3 voxel;       // where they start
  uint excluded;     // planes that do not count there
  bool crowded;      // other surface there
  uint directions;   // of its own set of them, the first
  Surface surface;   // kNear
};

Start startOf(uint s) {
  Start start;
  Face face = faceAt(s);
  start.f = face.key & 7u;
  uint packed = packedVoxel(face.key >> 3);
  start.seed = faceSeed(packed, start.f);
  start.coordinate = unpackVoxel(packed);
  start.normal = decodeNormal(face.normal);
  vec3 position = facePosition(face, start.coordinate);
  start.origin = liftedOrigin(position, start.normal);
  // The lift may lead over the border: a scrap of surface in a voxel's corner lies behind its neighbour's plane.
  start.voxel = voxelAt(start.origin);
  start.excluded = 0x3fu;
  start.crowded = false;
  if (kFrame == 1) {
    start.normal = faceVector(start.f);
    start.voxel = ivec3(start.coordinate) + ivec3(start.normal);
    start.origin = vec3(start.coordinate) + 0.5 + 0.5 * start.normal;
  } else if (kHit == kHitPlane) {
    uint voxel = voxelIndex(start.voxel);
    if (voxel != kNone) start.excluded = ownPlanes(voxel, uvec3(start.voxel), position, start.normal, start.crowded);
  } else {
    start.voxel = ivec3(start.coordinate);
  }
  start.directions = shiftOf(start.seed) * rayCount;
  start.surface = Surface(0u, 0u, false, 0.0);
  if (kNear) start.surface = surfaceOf(face.key >> 3, start.f);
  return start;
}

// Ray `at` of a face, kNear: from a piece of its surface. about: its normal, own: its triangle, or kNone.
TraversalRay rayFromPiece(Start start, uint at, out vec3 about, out uint own) {
  vec3 from = start.origin;
  about = start.normal;
  own = kNone;
  if (start.surface.total > 0.0) {
    // Strata of the surface, in an order that has nothing to do with that of the directions.
    uint turn = hashBits(start.seed ^ 0x51ed270bu);
    uint entry = pieceAt(start.surface, start.f, (float((at * 11u + turn) % rayCount) + 0.5) / float(rayCount), about);
    own = listedTriangle(triangleIds(entry));
    from = vec3(start.coordinate) + decodePosition(texelFetch(pieceTexels, int(2u * entry)).x) + kPieceLift * about;
  }
  return makeTraversalRay(from, alongNormal(decodeDirection(directions[start.directions + at]), about));
}

#endif
