#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// How much of each piece of surface is seen from farther than a voxel away: of rays from its middle, cosine-distributed about its normal, how many
// meet no triangle within one voxel edge. What is buried in other surface, or between two that touch, sends nothing to anybody, but
// shares voxel faces with what does. One lane an entry of the voxels' lists: neighbours test the same triangles.
#include "clustered_voxel/voxelize/material.glsl"
#include "shared/dispatch.glsl"
layout(local_size_x = 64) in;
layout(set = 0, binding = 7, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Rank { uint brickRank[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 10, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 11, scalar) readonly buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 12, scalar) writeonly buffer Pieces { uvec2 pieces[]; };  // shared/voxel_triangles.glsl
layout(constant_id = 3) const bool kExposed = true;
layout(push_constant, scalar) uniform Push {
  uint voxelCount;
  uint entryCount;
};
#include "shared/voxel_triangles.glsl"

const uint kExposureRays = 8u;
const float kExposureReach = 1.0;        // voxels
const float kExposureLift = 1e-3;        // voxels

uint exposureHash(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

// Rays of one set, which a hash turns about the normal. Points of the unit disc on a spiral of equal areas.
const vec2 kExposureDisc[kExposureRays] = vec2[](vec2(0.25, 0.0), vec2(-0.31929, 0.29248), vec2(0.04887, -0.55688), vec2(0.40244, 0.52492),
                                                 vec2(-0.73854, -0.13064), vec2(0.69960, -0.44504), vec2(-0.23400, 0.87048), vec2(-0.44627, -0.85927));

uint exposureOf(uint id, uvec3 voxel, vec3 position, vec3 n) {
  precise vec3 origin = vec3(voxel) + position + kExposureLift * n;
  ivec3 start = clamp(ivec3(floor(origin)), ivec3(0), ivec3(grid.size) - 1);
  uint bits = exposureHash(id ^ exposureHash(voxel.x | voxel.y << 10 | voxel.z << 20));
  float u = float(bits >> 8) * (2.0 / 16777216.0) - 1.0;
  float s = (bits & 1u) != 0u ? 1.0 : -1.0;
  precise float rest = max(1.0 - u * u, 1e-8);
  precise float v = s * rest * preciseInverseSqrt(rest);
  vec3 a = abs(n.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  precise vec3 b = vec3(n.y * a.z - n.z * a.y, n.z * a.x - n.x * a.z, n.x * a.y - n.y * a.x);
  precise vec3 tangent = b * preciseInverseSqrt(max(triangleDot(b, b), 1e-8));
  precise vec3 bitangent = vec3(n.y * tangent.z - n.z * tangent.y, n.z * tangent.x - n.x * tangent.z, n.x * tangent.y - n.y * tangent.x);
  uint seen = 0u;
  for (uint r = 0u; r < kExposureRays; ++r) {
    vec2 at = kExposureDisc[r];
    precise vec2 disc = vec2(at.x * u - at.y * v, at.x * v + at.y * u);
    precise float squared = max(1.0 - disc.x * disc.x - disc.y * disc.y, 1e-8);
    precise vec3 direction = tangent * disc.x + bitangent * disc.y + n * (squared * preciseInverseSqrt(squared));
    TraversalRay ray = makeTraversalRay(origin, direction);
    TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
    bool met = false;
    while (cursor.time < kExposureReach && !met && !any(lessThan(cursor.voxel, vec3(0.0))) && !any(greaterThanEqual(cursor.voxel, vec3(grid.size)))) {
      uvec3 at_ = uvec3(cursor.voxel);
      uint brick = brickOf(at_, grid.bricks);
      uint bit = bitOf(at_);
      uvec2 word = occupancy[brick];
      if (hasBit(word, bit)) {
        uint index = brickRank[brick] + countBitsBelow(word, bit);
        uint end = triangleFirst[index + 1u];
        for (uint e = triangleFirst[index]; e < end && !met; ++e) {
          float time;
          vec3 normal;
          met = triangleIds[e] != id && meetsTriangle(ray, triangleIds[e], 0.0, kExposureReach, time, normal);
        }
      }
      traversalStep(ray, cursor);
    }
    seen += met ? 0u : 1u;
  }
  return seen;
}


uint voxelOfEntry(uint entry) {
  uint low = 0u, high = voxelCount;
  while (high - low > 1u) {
    uint middle = (low + high) >> 1;
    if (triangleFirst[middle] <= entry)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void main() {
  uint entry = radivoxItemIndex();
  if (entry >= entryCount) return;
  uvec3 voxel = unpackVoxel(voxels[voxelOfEntry(entry)]);
  Triangle t = loadTriangle(triangleIds[entry]);
  Piece piece = measurePiece(t, turn(ivec3(voxel), t.axis));
  uvec2 packed = uvec2(0u);
  if (piece.area > 0.0) {
    vec3 position = turnBack(piece.middle, t.axis);
    vec3 n = turnBack(piece.normal, t.axis);
    uint front = kExposureRays, back = kExposureRays;
    if (kExposed) {
      front = exposureOf(t.id, voxel, position, n);
      back = reflectsOnBack(triangleMaterials[t.id]) ? exposureOf(t.id, voxel, position, -n) : 0u;
    }
    packed = uvec2(encodePosition(position), packHalf2x16(vec2(min(piece.area, 60000.0), 0.0)) | front << 16 | back << 24);
  }
  pieces[entry] = packed;
}
