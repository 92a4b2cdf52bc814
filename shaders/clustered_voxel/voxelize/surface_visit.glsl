// surface: sums of what the pieces bring to each voxel face, in fixed point.
#include "clustered_voxel/voxelize/material.glsl"
#include "shared/fixed_point.glsl"

layout(constant_id = 3) const bool kHeuristic = false;  // sum angles for normals=heuristic

layout(set = 0, binding = 7, scalar) readonly buffer Occupancy { uvec2 occupancy[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Rank { uint brickRank[]; };
layout(set = 0, binding = 9, scalar) readonly buffer FaceMasks { uint faceMasks[]; };
layout(set = 0, binding = 10, scalar) readonly buffer FirstFaces { uint firstFaces[]; };
// One buffer a quantity: each is as large as a binding can be.
layout(set = 0, binding = 11, scalar) buffer AreaSums { uint areaSums[]; };          // 2 words a face: Σ w
layout(set = 0, binding = 12, scalar) buffer AlbedoSums { uint albedoSums[]; };      // 6: Σ w ρ
layout(set = 0, binding = 13, scalar) buffer PositionSums { uint positionSums[]; };  // 6: Σ w x
layout(set = 0, binding = 14, scalar) buffer NormalSums { uint normalSums[]; };      // 6: Σ w (n + 1), so that carries are rare
layout(set = 0, binding = 15, scalar) buffer EmissionSums { uint emissionSums[]; };  // 6: Σ w L_e / 2^exponent, own side only
layout(set = 0, binding = 16, scalar) readonly buffer EmissionPeak { uint emissionPeak; };
layout(set = 0, binding = 17, scalar) buffer VoxelAreas { uint voxelAreas[]; };      // 2 words a voxel: Σ area
layout(set = 0, binding = 18, scalar) buffer AngleSums { uint angleSums[]; };        // 12 words a voxel: Σ area · angle(n, e_f)
layout(set = 0, binding = 19, scalar) buffer Footprints { uint footprints[]; };      // a word a face: footprintOf
layout(constant_id = 4) const bool kApart = false;  // pieces of other sides leave faces
layout(set = 0, binding = 20, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 21, scalar) readonly buffer TriangleIds { uint triangleIds[]; };

#include "clustered_voxel/apart.glsl"
#include "clustered_voxel/voxelize/emission_scale.glsl"
#include "clustered_voxel/voxelize/footprint.glsl"
#include "clustered_voxel/voxelize/shading_normal.glsl"

void addToFace(uint face, float weight, vec3 albedo, vec3 position, vec3 normal) {
  radivoxFixedAtomicAdd(areaSums[2u * face], areaSums[2u * face + 1u], toFixed(weight))
  for (uint k = 0u; k < 3u; ++k) {
    uint word = 6u * face + 2u * k;
    precise float weightedAlbedo = weight * albedo[k];
    precise float weightedPosition = weight * position[k];
    precise float weightedNormal = weight * clamp(normal[k] + 1.0, 0.0, 2.0);
    radivoxFixedAtomicAdd(albedoSums[word], albedoSums[word + 1u], toFixed(weightedAlbedo))
    radivoxFixedAtomicAdd(positionSums[word], positionSums[word + 1u], toFixed(weightedPosition))
    radivoxFixedAtomicAdd(normalSums[word], normalSums[word + 1u], toFixed(weightedNormal))
  }
}

// Abramowitz and Stegun 4.4.45, error below 7e-5 rad.
float angleBetween(float cosine) {
  float x = min(abs(cosine), 1.0);
  precise float rest = 1.0 - x;
  precise float root = rest > 1e-12 ? rest * preciseInverseSqrt(rest) : 0.0;
  precise float angle = root * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
  precise float obtuse = 3.14159265 - angle;
  return cosine < 0.0 ? obtuse : angle;
}

void visitVoxel(Triangle t, ivec3 turned) {
  Piece piece = measurePiece(t, turned);
  if (!(piece.area > 0.0)) return;
  uint material = triangleMaterials[t.id];
  Surface surface = surfaceOf(t, turned, piece, material);
  if (!(surface.coverage > 0.0)) return;

  uvec3 voxel = uvec3(turnBack(turned, t.axis));
  uint brick = brickOf(voxel, grid.bricks);
  uint index = brickRank[brick] + countBitsBelow(occupancy[brick], bitOf(voxel));  // overlapped, so occupied
  uint mask = faceMasks[index];
  uint first = firstFaces[index];
  vec3 position = turnBack(surface.point, t.axis);
  vec3 geometric = turnBack(piece.normal, t.axis);
  vec3 normal = shadingNormal(t, turned, piece, geometric);
  precise float area = piece.area * surface.coverage;
  radivoxFixedAtomicAdd(voxelAreas[2u * index], voxelAreas[2u * index + 1u], toFixed(area))
  if (kHeuristic) {
    for (uint f = 0u; f < kFaceCount; ++f) {
      vec3 e = faceVector(f);
      precise float angle = angleBetween(normal.x * e.x + normal.y * e.y + normal.z * e.z);
      precise float weighted = area * angle;
      uint word = 12u * index + 2u * f;
      radivoxFixedAtomicAdd(angleSums[word], angleSums[word + 1u], toFixed(weighted))
    }
  }
  // A one-sided surface adds to its front alone, even where backs reflect too: see surface_resolve.comp.
  bool doubleSided = (materials[material].flags & kMaterialDoubleSided) != 0u;
  uint apart = kApart ? apartIn(index, t.id) : 0u;
  // One loop, so that the additions are compiled once: k = s / 2; even s add to the front.
  vec3 weights = weightsOf(t, piece, surface);
  for (uint s = 0u; s < 6u; ++s) {
    uint k = s >> 1;
    bool isBack = (s & 1u) != 0u;
    float weight = weights[k];
    if (toFixed(weight) == uvec2(0u) || (isBack && !doubleSided)) continue;
    uint front = 2u * worldAxis(t, k) + (piece.normal[k] < 0.0 ? 1u : 0u);
    uint frontFace = first + uint(bitCount(mask & ((1u << front) - 1u)));
    uint f = isBack ? front ^ 1u : front;
    if (((apart >> f) & 1u) != 0u) continue;
    uint face = first + uint(bitCount(mask & ((1u << f) - 1u)));
    uint footprint = footprintOf(t, turned, piece, k);
    if ((footprints[face] & footprint) != footprint) atomicOr(footprints[face], footprint);
    addToFace(face, weight, surface.albedo, position, isBack ? -normal : normal);
    if (!kEmissive || isBack || !any(greaterThan(surface.emission, vec3(0.0)))) continue;
    for (uint c = 0u; c < 3u; ++c) {
      uint word = 6u * frontFace + 2u * c;
      precise float weighted = weight * (surface.emission[c] * emissionDownscale(emissionPeak));
      radivoxFixedAtomicAdd(emissionSums[word], emissionSums[word + 1u], toFixed(weighted))
    }
  }
}
