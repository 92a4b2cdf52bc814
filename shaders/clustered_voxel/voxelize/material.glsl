// What a piece of surface carries: how much of it is there (alpha mask), its albedo, its emission. Textures are read at points spread
// over the piece. The includer declares the extensions of shared/texture.glsl.
#ifndef RADIVOX_VOXELIZE_MATERIAL_GLSL
#define RADIVOX_VOXELIZE_MATERIAL_GLSL
#include "clustered_voxel/voxelize/piece.glsl"
#include "shared/face_shares.h"
#include "shared/texture.glsl"

layout(constant_id = 0) const bool kTextured = false;  // some material has a texture
layout(constant_id = 1) const bool kMasked = false;    // some material has an alpha mask
layout(constant_id = 2) const bool kEmissive = false;  // some material emits

layout(set = 0, binding = 4, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Textures { Texture textures[]; };

// Points a side of the grid laid over the piece's bounds; about half of them fall on the piece.
const uint kMaskedSide = 6u;
const uint kTexturedSide = 2u;

// Mip level whose texels are about as large as a point's share of the piece's bounds.
uint levelOf(Triangle t, Piece piece, uint side, vec2 uv[3], uint texture_) {
  precise vec2 a = uv[1] - uv[0];
  precise vec2 b = uv[2] - uv[0];
  precise float texels = abs(a.x * b.y - a.y * b.x) * float(textures[texture_].width) * float(textures[texture_].height);
  // Of the triangle's parallelogram, whose area along the dominant axis is normal.z.
  precise vec2 cell = (piece.high - piece.low) * preciseReciprocal(float(side));
  precise float share = cell.x * cell.y * preciseReciprocal(abs(t.normal.z));
  precise float texelsPerPoint = texels * share;
  int exponent = int(floatBitsToUint(texelsPerPoint) >> 23) - 127;  // floor(log₂)
  return min(uint(max(exponent, 0)) / 2u, textures[texture_].levelCount - 1u);
}

vec2 interpolate(vec2 uv[3], vec2 weights) {
  precise vec2 at = uv[0] + (uv[1] - uv[0]) * weights.x + (uv[2] - uv[0]) * weights.y;
  return at;
}

struct Surface {
  float coverage;  // fraction of the piece that is there
  vec3 albedo;     // means over what is there
  vec3 emission;   // L_e
  vec3 point;      // relative to the voxel's low corner, turned
};

Surface surfaceOf(Triangle t, ivec3 voxel, Piece piece, uint material) {
  Surface surface = Surface(1.0, materials[material].albedo, vec3(0.0), piece.middle);
  if (kEmissive && (materials[material].flags & kMaterialEmissive) != 0u) surface.emission = materials[material].emission;
  bool isMasked = kMasked && (materials[material].flags & kMaterialAlphaMask) != 0u;
  uint base = kTextured ? materials[material].baseTexture : kNoTexture;
  uint emissive = kTextured && kEmissive ? materials[material].emissiveTexture : kNoTexture;
  if (base == kNoTexture && emissive == kNoTexture) {
    if (isMasked && materials[material].alpha < materials[material].alphaCutoff) surface.coverage = 0.0;
    return surface;
  }
  vec2 uvBase[3], uvEmissive[3];
  for (uint c = 0u; c < 3u; ++c) {
    uint vertex = indices[3u * t.id + c];
    uvBase[c] = vertices[vertex].uvBase;
    uvEmissive[c] = vertices[vertex].uvEmissive;
  }
  isMasked = isMasked && base != kNoTexture;
  uint side = isMasked ? kMaskedSide : kTexturedSide;
  // A mask is cut at its finest level: averaged alpha would thicken or lose thin leaves.
  uint levelBase = base == kNoTexture || isMasked ? 0u : levelOf(t, piece, side, uvBase, base);
  uint levelEmissive = emissive == kNoTexture ? 0u : levelOf(t, piece, side, uvEmissive, emissive);
  vec3 corner = cornerInVoxel(t, 0u, voxel);
  vec3 slopes = scaledNormal(t);
  uint met = 0u, covered = 0u;
  precise vec3 albedo = vec3(0.0);
  precise vec3 emission = vec3(0.0);
  precise vec3 point = vec3(0.0);
  // The last round stands in for pieces too small for the grid: their centroid.
  for (uint s = 0u; s < side * side + 1u; ++s) {
    bool isLast = s == side * side;
    if (isLast && met > 0u) break;
    precise vec2 at = piece.low + (piece.high - piece.low) * ((vec2(s % side, s / side) + 0.5) * preciseReciprocal(float(side)));
    if (isLast) at = piece.middle.xy;
    vec2 weights = barycentricOf(t, voxel, at);
    float height = planeHeight(corner, slopes, at);
    bool isOn = weights.x >= 0.0 && weights.y >= 0.0 && weights.x + weights.y <= 1.0 && height >= 0.0 && height <= 1.0;
    if (!isOn && !isLast) continue;
    weights = clampToTriangle(weights);
    ++met;
    vec4 texel = base == kNoTexture ? vec4(1.0) : sampleTextureLevel(textures[base], interpolate(uvBase, weights), levelBase);
    precise float alpha = texel.a * materials[material].alpha;
    if (isMasked && alpha < materials[material].alphaCutoff) continue;
    ++covered;
    albedo = albedo + texel.rgb;
    point = point + vec3(at, clamp(height, 0.0, 1.0));
    if (emissive != kNoTexture)
      emission = emission + sampleTextureLevel(textures[emissive], interpolate(uvEmissive, weights), levelEmissive).rgb;
  }
  if (covered == 0u) {
    surface.coverage = 0.0;
    return surface;
  }
  float scale = preciseReciprocal(float(covered));
  precise vec3 meanAlbedo = surface.albedo * (albedo * scale);
  precise vec3 meanPoint = point * scale;
  surface.albedo = meanAlbedo;
  if (emissive != kNoTexture) {
    precise vec3 meanEmission = surface.emission * (emission * scale);
    surface.emission = meanEmission;
  }
  if (isMasked && covered < met) {
    precise float coverage = float(covered) * preciseReciprocal(float(met));
    surface.coverage = coverage;
    surface.point = meanPoint;
  }
  return surface;
}

// Does the side of the surface that looks along −normal reflect?
bool reflectsOnBack(uint material) { return grid.singleSided == 0u || (materials[material].flags & kMaterialDoubleSided) != 0u; }

uint worldAxis(Triangle t, uint k) { return (t.axis + 1u + k) % 3u; }

// What the piece adds to the face pairs of the turned axes: its shares of the area, h². Faces exist iff the fixed-point value is above 0.
vec3 weightsOf(Triangle t, Piece piece, Surface surface) {
  vec3 shares = faceShares(turnBack(piece.normal, t.axis), grid.dominant != 0u);
  precise vec3 weights = piece.area * surface.coverage * vec3(shares[worldAxis(t, 0u)], shares[worldAxis(t, 1u)], shares[worldAxis(t, 2u)]);
  return weights;
}

#endif
