#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Which faces of its voxel each listed piece is no part of. One lane a voxel.
//
// Where thin walls meet, a voxel face looks at the inner side of one and at the outer side of the other: a mean of both would carry the light of one
// side to the other. So the largest piece of a face leads it, and pieces across a wall from the leader are no part of the face. Surfaces that
// bound the same space each reach in front of the other (a corner of a room), or neither does (a corner of a block); where only one does, something
// solid lies between. And what is hidden right behind another piece of its face is no part of it: it is never lit, and would dim all the face sends.
#include "shared/dispatch.glsl"
#include "shared/face_shares.h"
#include "shared/listed_triangle.h"
#include "shared/scene.h"
#include "shared/voxel_codec.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 4, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 5, scalar) buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Pieces { uvec2 pieces[]; };
layout(set = 0, binding = 7, scalar) readonly buffer GridBuffer { Grid grid; };
layout(set = 0, binding = 8, scalar) readonly buffer Voxels { uint voxels[]; };
layout(push_constant, scalar) uniform Push { uint voxelCount; };

const float kApartCosine = 0.5;   // surfaces closer in direction than this are one that bends
const float kBendCosine = 0.87;   // half that angle: two surfaces that close to a third are one
const float kApartSlack = 0.01;   // voxels; middles are good to 1e-3
const float kLeastLeader = 1e-5;  // h²; surface along a face's axis may be no part of it by rounding, and must not lead it
const uint kMostParted = 64u;     // pieces; a voxel of more keeps them all. (llvmpipe ends a lane's loops after 65535 rounds.)

#include "shared/triangle_normal.glsl"

struct Side {
  uint triangle;
  vec3 normal;  // outward
  vec3 middle;  // in the voxel
};

// Does any of the triangle's piece in the voxel lie in front of the plane through x with normal n? Its corners are ends of the triangle's edges, cut by
// the voxel, and crossings of the voxel's edges with the triangle.
bool reachesAhead(Side piece, vec3 voxel, vec3 n, vec3 x) {
  uint id = piece.triangle;
  precise vec3 ahead = piece.middle - x;
  if (triangleDot(ahead, n) > kApartSlack) return true;
  vec3 p[3];
  for (uint c = 0u; c < 3u; ++c) {
    precise vec3 at = toGridSpace(grid, vertices[indices[3u * id + c]].position) - voxel;
    p[c] = at;
  }
  for (uint e = 0u; e < 3u; ++e) {
    vec3 a = p[e];
    precise vec3 d = p[(e + 1u) % 3u] - a;
    float enter = 0.0, leave = 1.0;
    for (uint k = 0u; k < 3u; ++k) {
      if (abs(d[k]) < 1e-6) {
        if (a[k] < 0.0 || a[k] > 1.0) leave = -1.0;
        continue;
      }
      float inverse = preciseReciprocal(abs(d[k])) * (d[k] < 0.0 ? -1.0 : 1.0);
      precise float low = -a[k] * inverse;
      precise float high = (1.0 - a[k]) * inverse;
      enter = max(enter, min(low, high));
      leave = min(leave, max(low, high));
    }
    precise vec3 from = a + d * enter - x;
    precise vec3 to = a + d * leave - x;
    if (enter <= leave && max(triangleDot(from, n), triangleDot(to, n)) > kApartSlack) return true;
  }
  precise vec3 e1 = p[1] - p[0];
  precise vec3 e2 = p[2] - p[0];
  precise vec3 m = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
  for (uint edge = 0u; edge < 12u; ++edge) {
    uint k = edge >> 2, i = (k + 1u) % 3u, j = (k + 2u) % 3u;
    if (abs(m[k]) < 1e-6) continue;
    vec3 y;
    y[i] = float(edge & 1u);
    y[j] = float((edge >> 1) & 1u);
    precise float across = m[i] * (y[i] - p[0][i]) + m[j] * (y[j] - p[0][j]);
    precise float along = p[0][k] - across * preciseReciprocal(abs(m[k])) * (m[k] < 0.0 ? -1.0 : 1.0);
    y[k] = along;
    bool inside = along >= 0.0 && along <= 1.0;
    for (uint e = 0u; e < 3u; ++e) {
      precise vec3 d = p[(e + 1u) % 3u] - p[e];
      precise vec3 q = y - p[e];
      precise float side = (d[i] * q[j] - d[j] * q[i]) * m[k];
      inside = inside && side >= 0.0;
    }
    precise vec3 reach = y - x;
    if (inside && triangleDot(reach, n) > kApartSlack) return true;
  }
  return false;
}

bool isApart(Side leader, Side piece, vec3 voxel) {
  if (triangleDot(leader.normal, piece.normal) > kApartCosine) return false;
  return reachesAhead(piece, voxel, leader.normal, leader.middle) != reachesAhead(leader, voxel, piece.normal, piece.middle);
}

uint faceTowards(vec3 n, uint k) { return 2u * k + (n[k] < 0.0 ? 1u : 0u); }

// Faces of pieces that hide x, the middle of a piece with normal n, from above: they look the same way, and stand before it in the voxel.
uint coveringFaces(uint begin, uint end, vec3 n, vec3 x, vec3 voxel, bool dominant) {
  uint faces = 0u;
  for (uint e = begin; e < end; ++e) {
    precise vec3 ahead = decodePosition(pieces[e].x) - x;
    if (triangleDot(ahead, n) <= kApartSlack) continue;
    uint other = listedTriangle(triangleIds[e]);
    uint flags = materials[triangleMaterials[other]].flags;
    if ((flags & kMaterialAlphaMask) != 0u) continue;
    vec3 front = triangleNormal(other);
    bool turned = (flags & kMaterialDoubleSided) != 0u && triangleDot(front, n) < 0.0;
    vec3 m = turned ? -front : front;
    float slope = triangleDot(m, n);
    if (slope <= kApartCosine) continue;
    vec3 p[3];
    for (uint c = 0u; c < 3u; ++c) {
      precise vec3 at = toGridSpace(grid, vertices[indices[3u * other + c]].position) - voxel - x;
      p[c] = at;
    }
    // x + t n on the plane of `other`: t = (p · m) / (n · m).
    precise float t = triangleDot(p[0], m) * preciseReciprocal(slope);
    if (t <= kApartSlack) continue;
    precise vec3 hit = t * n;
    if (any(lessThan(x + hit, vec3(0.0))) || any(greaterThan(x + hit, vec3(1.0)))) continue;
    bool covers = true;
    for (uint c = 0u; c < 3u; ++c) {
      vec3 a = p[c];
      precise vec3 d = p[(c + 1u) % 3u] - a;
      precise vec3 q = hit - a;
      precise vec3 across = vec3(d.y * q.z - d.z * q.y, d.z * q.x - d.x * q.z, d.x * q.y - d.y * q.x);
      covers = covers && triangleDot(across, front) >= 0.0;
    }
    vec3 shares = faceShares(m, dominant);
    for (uint k = 0u; k < 3u; ++k) faces |= covers && shares[k] > 0.0 ? 1u << faceTowards(m, k) : 0u;
  }
  return faces;
}

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= voxelCount) return;
  uint begin = triangleFirst[voxel], end = triangleFirst[voxel + 1u];
  if (end < begin + 2u || end - begin > kMostParted) return;
  // Most voxels hold one surface, or one that bends.
  vec3 first = triangleNormal(triangleIds[begin]);
  bool bends = true;
  bool layered = false;
  for (uint e = begin + 1u; e < end; ++e) {
    bends = bends && abs(triangleDot(triangleNormal(triangleIds[e]), first)) > kBendCosine;
    precise vec3 step = decodePosition(pieces[e].x) - decodePosition(pieces[begin].x);
    layered = layered || abs(triangleDot(step, first)) > kApartSlack;
  }
  if (bends && !layered) return;
  bool dominant = grid.dominant != 0u;
  vec3 voxelCorner = vec3(unpackVoxel(voxels[voxel]));
  float most[kFaceCount];
  uint leader[kFaceCount];
  Side sides[kFaceCount];
  for (uint f = 0u; f < kFaceCount; ++f) {
    most[f] = kLeastLeader;
    leader[f] = kNone;
  }
  for (uint e = begin; e < end && !bends; ++e) {
    uint flags = materials[triangleMaterials[triangleIds[e]]].flags;
    // How much of a piece an alpha mask leaves is not known here.
    if ((flags & kMaterialAlphaMask) != 0u) continue;
    uvec2 piece = pieces[e];
    vec3 front = triangleNormal(triangleIds[e]);
    uint sideCount = (flags & kMaterialDoubleSided) != 0u ? 2u : 1u;
    for (uint s = 0u; s < sideCount; ++s) {
      vec3 n = s == 0u ? front : -front;
      vec3 shares = faceShares(n, dominant);
      for (uint k = 0u; k < 3u; ++k) {
        uint f = faceTowards(n, k);
        precise float weight = shares[k] * uintBitsToFloat(piece.y);
        if (weight <= most[f]) continue;
        most[f] = weight;
        leader[f] = e;
        sides[f] = Side(triangleIds[e], n, decodePosition(piece.x));
      }
    }
  }
  for (uint e = begin; e < end; ++e) {
    uint id = triangleIds[e];
    uint flags = materials[triangleMaterials[id]].flags;
    if ((flags & kMaterialAlphaMask) != 0u) continue;
    bool isDouble = (flags & kMaterialDoubleSided) != 0u;
    vec3 front = triangleNormal(id), middle = decodePosition(pieces[e].x);
    uint apart = 0u;
    for (uint s = 0u; s < (isDouble ? 2u : 1u); ++s) {
      vec3 n = s == 0u ? front : -front;
      uint leaves = 0u;
      bool stays = dominant;  // of several faces, a piece that none would keep stays in all
      vec3 shares = faceShares(n, dominant);
      uint covering = layered ? coveringFaces(begin, end, n, middle, voxelCorner, dominant) : 0u;
      for (uint k = 0u; k < 3u; ++k) {
        uint f = faceTowards(n, k);
        if (shares[k] == 0.0) continue;
        bool leavesIt = leader[f] != kNone && leader[f] != e && isApart(sides[f], Side(id, n, middle), voxelCorner);
        leavesIt = leavesIt || ((covering >> f) & 1u) != 0u;
        leaves |= leavesIt ? 1u << f : 0u;
        stays = stays || !leavesIt;
      }
      apart |= stays ? leaves : 0u;
    }
    // The back of a one-sided surface is where its front is.
    if (!isDouble) apart |= (apart & 21u) << 1 | ((apart >> 1) & 21u);
    if (apart != 0u) triangleIds[e] = id | apart << kListedBits;
  }
}
