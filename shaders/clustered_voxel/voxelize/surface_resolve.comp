#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// From sums to faces: one lane a voxel writes its up to six faces. The voxels' areas are summed up as well, for the check against the mesh.
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_VOXELS 2
#define RADIVOX_BIND_FACE_MASK 3
#define RADIVOX_BIND_FIRST_FACE 4
#include "shared/voxel_lookup.glsl"
#include "clustered_voxel/voxelize/emission_scale.glsl"
#include "shared/dispatch.glsl"
#include "shared/fixed_point.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kEmission = false;   // the port is wanted
layout(constant_id = 1) const bool kHeuristic = false;  // normals=heuristic

layout(set = 0, binding = 5, scalar) readonly buffer AreaSums { uvec2 areaSums[]; };
layout(set = 0, binding = 6, scalar) readonly buffer AlbedoSums { uvec2 albedoSums[]; };
layout(set = 0, binding = 7, scalar) readonly buffer PositionSums { uvec2 positionSums[]; };
layout(set = 0, binding = 8, scalar) readonly buffer NormalSums { uvec2 normalSums[]; };
layout(set = 0, binding = 9, scalar) readonly buffer EmissionSums { uvec2 emissionSums[]; };
layout(set = 0, binding = 10, scalar) readonly buffer EmissionPeak { uint emissionPeak; };
layout(set = 0, binding = 11, scalar) readonly buffer VoxelAreas { uvec2 voxelAreas[]; };
layout(set = 0, binding = 12, scalar) readonly buffer AngleSums { uvec2 angleSums[]; };
layout(set = 0, binding = 13, scalar) writeonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 14, scalar) writeonly buffer Emission { vec3 emission[]; };
layout(set = 0, binding = 15, scalar) buffer TotalArea { uint totalArea[2]; };
layout(set = 0, binding = 16, scalar) readonly buffer Footprints { uint footprints[]; };
layout(push_constant, scalar) uniform Push { uint voxelCount; };

shared uint groupArea[2];

vec3 meanOf(uvec2 x, uvec2 y, uvec2 z, float scale) {
  precise vec3 mean = vec3(fixedToFloat(x), fixedToFloat(y), fixedToFloat(z)) * scale;
  return mean;
}

bool isLess(uvec2 a, uvec2 b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

// The paper's normal of a voxel: the direction whose 3 × 3 neighbours are the most free; among equals the one closest to the surface.
vec3 heuristicNormal(uint voxel) {
  ivec3 coordinate = ivec3(voxelCoordinate(voxel));
  uint bestFree = 0u, best = 0u;
  uvec2 bestAngle = uvec2(0xffffffffu);
  for (uint f = 0u; f < kFaceCount; ++f) {
    uint axis = f >> 1;
    uint free = 0u;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        ivec3 offset = ivec3(faceVector(f));
        offset[(axis + 1u) % 3u] = i;
        offset[(axis + 2u) % 3u] = j;
        free += isOccupied(coordinate + offset) ? 0u : 1u;
      }
    }
    uvec2 angle = angleSums[6u * voxel + f];
    if (free > bestFree || (free == bestFree && isLess(angle, bestAngle))) {
      bestFree = free;
      bestAngle = angle;
      best = f;
    }
  }
  return faceVector(best);
}

// Σ w (n + 1) − Σ w over Σ w, normalised; e_f where the surface's normals cancel.
vec3 meanNormal(uint slot, uvec2 area, float scale, uint f, bool flipped) {
  uvec2 minus = fixedNegate(area);
  vec3 mean = meanOf(fixedAdd(normalSums[3u * slot], minus), fixedAdd(normalSums[3u * slot + 1u], minus),
                     fixedAdd(normalSums[3u * slot + 2u], minus), scale);
  precise float squared = mean.x * mean.x + mean.y * mean.y + mean.z * mean.z;
  if (!(squared > 1e-8)) return faceVector(f);
  precise vec3 normal = mean * (preciseInverseSqrt(squared) * (flipped ? -1.0 : 1.0));
  return normal;
}

// faceMargins of a face's footprints: free slabs below the lowest and above the highest.
uint marginsOf(uint footprint) {
  uint u = footprint & 0xffffu, v = footprint >> 16;
  if (u == 0u || v == 0u) return 0u;
  return uint(findLSB(u)) | (15u - uint(findMSB(u))) << 4 | uint(findLSB(v)) << 8 | (15u - uint(findMSB(v))) << 12;
}

void writeFaces(uint voxel) {
  uint mask = faceMask(voxel);
  uint face = firstFace(voxel);
  vec3 axisNormal = kHeuristic && mask != 0u ? heuristicNormal(voxel) : vec3(0.0);
  for (uint f = 0u; f < kFaceCount; ++f) {
    if (((mask >> f) & 1u) == 0u) continue;
    // A face is made of the surface whose front it shows. Only where there is none does it show backs, seen from the other side: those of a wall's two
    // skins lie inside the wall, unlit and out of sight, and would darken the fronts that share their voxels.
    bool shows = areaSums[face] != uvec2(0u);
    uint slot = shows ? face : ((f & 1u) != 0u ? face - 1u : face + 1u);
    uvec2 area = areaSums[slot];
    precise float scale = preciseReciprocal(fixedToFloat(area));
    vec3 normal = meanNormal(slot, area, scale, f, !shows);
    if (kHeuristic) {
      precise float side = axisNormal.x * normal.x + axisNormal.y * normal.y + axisNormal.z * normal.z;
      normal = side < 0.0 ? -axisNormal : axisNormal;
    }
    faces[face].key = voxel << 3 | f;
    faces[face].area = fixedToFloat(area);
    faces[face].normal = encodeNormal(normal);
    vec3 position = meanOf(positionSums[3u * slot], positionSums[3u * slot + 1u], positionSums[3u * slot + 2u], scale);
    faces[face].position = encodePosition(position) | (shows ? 0u : kMadeOfBacks);
    uvec2 albedo = encodeAlbedo(meanOf(albedoSums[3u * slot], albedoSums[3u * slot + 1u], albedoSums[3u * slot + 2u], scale));
    faces[face].albedo = withMargins(albedo, marginsOf(footprints[slot]));
    if (kEmission) {
      vec3 mean = meanOf(emissionSums[3u * face], emissionSums[3u * face + 1u], emissionSums[3u * face + 2u], scale);
      precise vec3 radiosity = mean * emissionUpscale(emissionPeak) * 3.14159265;
      emission[face] = radiosity;
    }
    ++face;
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0u) groupArea[0] = groupArea[1] = 0u;
  barrier();
  uint voxel = radivoxItemIndex();
  if (voxel < voxelCount) {
    writeFaces(voxel);
    radivoxFixedAtomicAdd(groupArea[0], groupArea[1], voxelAreas[voxel])
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) radivoxFixedAtomicAdd(totalArea[0], totalArea[1], uvec2(groupArea[0], groupArea[1]))
}
