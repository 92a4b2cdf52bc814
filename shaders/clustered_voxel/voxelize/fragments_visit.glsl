// fragments: how many triangles a voxel meets, and sums of their normals in fixed point.
#include "clustered_voxel/voxelize/material.glsl"
#include "clustered_voxel/voxelize/shading_normal.glsl"
#include "shared/fixed_point.glsl"

layout(constant_id = 3) const bool kNormals = false;  // somebody reads the normals

layout(set = 0, binding = 7, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Rank { uint brickRank[]; };
layout(set = 0, binding = 9, scalar) buffer Fragments { uint fragments[]; };
layout(set = 0, binding = 10, scalar) buffer AreaSums { uint areaSums[]; };      // 2 words a voxel: Σ area
layout(set = 0, binding = 11, scalar) buffer NormalSums { uint normalSums[]; };  // 6: Σ area (n + 1), so that carries are rare

void visitVoxel(Triangle t, ivec3 turned) {
  uvec3 voxel = uvec3(turnBack(turned, t.axis));
  uint brick = brickOf(voxel, grid.bricks);
  uint index = brickRank[brick] + countBitsBelow(occupancy[brick], bitOf(voxel));  // overlapped, so occupied
  atomicAdd(fragments[index], 1u);
  if (!kNormals) return;
  Piece piece = measurePiece(t, turned);
  if (!(piece.area > 0.0)) return;
  Surface surface = surfaceOf(t, turned, piece, triangleMaterials[t.id]);
  precise float area = piece.area * surface.coverage;
  if (!(area > 0.0)) return;
  vec3 normal = shadingNormal(t, turned, piece, turnBack(piece.normal, t.axis));
  radivoxFixedAtomicAdd(areaSums[2u * index], areaSums[2u * index + 1u], toFixed(area))
  for (uint k = 0u; k < 3u; ++k) {
    uint word = 6u * index + 2u * k;
    precise float weighted = area * clamp(normal[k] + 1.0, 0.0, 2.0);
    radivoxFixedAtomicAdd(normalSums[word], normalSums[word + 1u], toFixed(weighted))
  }
}
