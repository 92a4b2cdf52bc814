// faces: which faces of the voxel the piece gives area to.
#include "clustered_voxel/voxelize/material.glsl"
#include "shared/fixed_point.glsl"

layout(set = 0, binding = 7, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Rank { uint brickRank[]; };
layout(set = 0, binding = 9, scalar) buffer FaceMasks { uint faceMasks[]; };

void visitVoxel(Triangle t, ivec3 turned) {
  Piece piece = measurePiece(t, turned);
  if (!(piece.area > 0.0)) return;
  uint material = triangleMaterials[t.id];
  Surface surface = surfaceOf(t, turned, piece, material);
  if (!(surface.coverage > 0.0)) return;
  bool back = reflectsOnBack(material);
  uint mask = 0u;
  vec3 weights = weightsOf(t, piece, surface);
  for (uint k = 0u; k < 3u; ++k) {
    if (toFixed(weights[k]) == uvec2(0u)) continue;
    uint pair = 2u * worldAxis(t, k);
    bool negative = piece.normal[k] < 0.0;
    mask |= back ? 3u << pair : (negative ? 2u : 1u) << pair;
  }
  if (mask == 0u) return;
  uvec3 voxel = uvec3(turnBack(turned, t.axis));
  uint brick = brickOf(voxel, grid.bricks);
  uint index = brickRank[brick] + countBitsBelow(occupancy[brick], bitOf(voxel));  // overlapped, so occupied
  if ((faceMasks[index] & mask) != mask) atomicOr(faceMasks[index], mask);
}
