// How voxels and faces are packed (see voxel.h): coordinates, bits of a brick, face directions, and the fields of Face.
// C++ and GLSL compile the same text and get the same bits.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_CODEC_H
#define RADIVOX_SHADERS_SHARED_VOXEL_CODEC_H
#include "functions.h"
#include "voxel.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kNone = 0xffffffffu;  // no such voxel or face

RADIVOX_FUNCTION uint packVoxel(uvec3 voxel) { return voxel.x | voxel.y << 10 | voxel.z << 20; }
RADIVOX_FUNCTION uvec3 unpackVoxel(uint word) { return uvec3(word & 1023u, (word >> 10) & 1023u, word >> 20); }

RADIVOX_FUNCTION uint brickOf(uvec3 voxel, uvec3 bricks) {
  return (voxel.x >> 2) + bricks.x * ((voxel.y >> 2) + bricks.y * (voxel.z >> 2));
}
RADIVOX_FUNCTION uvec3 brickCoordinate(uint brick, uvec3 bricks) {
  return uvec3(brick % bricks.x, (brick / bricks.x) % bricks.y, brick / (bricks.x * bricks.y));
}
RADIVOX_FUNCTION uint bitOf(uvec3 voxel) { return (voxel.x & 3u) | (voxel.y & 3u) << 2 | (voxel.z & 3u) << 4; }
RADIVOX_FUNCTION uvec3 bitCoordinate(uint bit) { return uvec3(bit & 3u, (bit >> 2) & 3u, bit >> 4); }
RADIVOX_FUNCTION bool hasBit(uvec2 word, uint bit) { return (((bit < 32u ? word.x : word.y) >> (bit & 31u)) & 1u) != 0u; }
RADIVOX_FUNCTION uint countBits(uvec2 word) { return uint(bitCount(word.x)) + uint(bitCount(word.y)); }
RADIVOX_FUNCTION uint countBitsBelow(uvec2 word, uint bit) {
  uint below = (1u << (bit & 31u)) - 1u;
  return bit < 32u ? uint(bitCount(word.x & below)) : uint(bitCount(word.x)) + uint(bitCount(word.y & below));
}

// e_f; f = 0…5: +x −x +y −y +z −z.
RADIVOX_FUNCTION vec3 faceVector(uint f) {
  float sign = (f & 1u) == 0u ? 1.0f : -1.0f;
  return vec3(f >> 1 == 0u ? sign : 0.0f, f >> 1 == 1u ? sign : 0.0f, f >> 1 == 2u ? sign : 0.0f);
}

// Unit vector ↔ octahedral snorm16 × 2, x in the low half. The zero vector encodes as +z.
RADIVOX_FUNCTION uint encodeNormal(vec3 n) {
  RADIVOX_PRECISE float sum = abs(n.x) + abs(n.y) + abs(n.z);
  if (!(sum > 1e-30f)) return 0u;
  RADIVOX_PRECISE float scale = preciseReciprocal(sum);
  RADIVOX_PRECISE float x = n.x * scale;
  RADIVOX_PRECISE float y = n.y * scale;
  if (n.z < 0.0f) {
    RADIVOX_PRECISE float foldedX = (1.0f - abs(y)) * (x >= 0.0f ? 1.0f : -1.0f);
    RADIVOX_PRECISE float foldedY = (1.0f - abs(x)) * (y >= 0.0f ? 1.0f : -1.0f);
    x = foldedX;
    y = foldedY;
  }
  RADIVOX_PRECISE float roundedX = floor(x * 32767.0f + 0.5f);
  RADIVOX_PRECISE float roundedY = floor(y * 32767.0f + 0.5f);
  int codeX = int(clamp(roundedX, -32767.0f, 32767.0f));
  int codeY = int(clamp(roundedY, -32767.0f, 32767.0f));
  return (uint(codeX) & 0xffffu) | (uint(codeY) & 0xffffu) << 16;
}
RADIVOX_FUNCTION vec3 decodeNormal(uint code) {
  int codeX = int(code << 16) >> 16;
  int codeY = int(code) >> 16;
  RADIVOX_PRECISE float x = float(codeX) * (1.0f / 32767.0f);
  RADIVOX_PRECISE float y = float(codeY) * (1.0f / 32767.0f);
  RADIVOX_PRECISE float z = 1.0f - abs(x) - abs(y);
  RADIVOX_PRECISE float fold = max(-z, 0.0f);
  x = x + (x >= 0.0f ? -fold : fold);
  y = y + (y >= 0.0f ? -fold : fold);
  RADIVOX_PRECISE float squared = x * x + y * y + z * z;
  RADIVOX_PRECISE float scale = preciseInverseSqrt(squared);
  RADIVOX_PRECISE vec3 n = vec3(x * scale, y * scale, z * scale);
  return n;
}

// Position inside the voxel, [0, 1]³ ↔ unorm 10:10:10, x low.
RADIVOX_FUNCTION uint encodePosition(vec3 p) {
  RADIVOX_PRECISE float x = floor(clamp(p.x, 0.0f, 1.0f) * 1023.0f + 0.5f);
  RADIVOX_PRECISE float y = floor(clamp(p.y, 0.0f, 1.0f) * 1023.0f + 0.5f);
  RADIVOX_PRECISE float z = floor(clamp(p.z, 0.0f, 1.0f) * 1023.0f + 0.5f);
  return uint(x) | uint(y) << 10 | uint(z) << 20;
}
RADIVOX_FUNCTION vec3 decodePosition(uint code) {
  RADIVOX_PRECISE float x = float(code & 1023u) * (1.0f / 1023.0f);
  RADIVOX_PRECISE float y = float((code >> 10) & 1023u) * (1.0f / 1023.0f);
  RADIVOX_PRECISE float z = float((code >> 20) & 1023u) * (1.0f / 1023.0f);
  return vec3(x, y, z);
}

// Albedo in [0, 0.999] ↔ 16 bits a channel: r | g << 16, b. Light that bounces grows as 1 / (1 − ρ), so it is 1 − ρ that must be kept:
// ρ = 0.999 (1 − t²), t = 1 − code / 65535. Exact at 0 and at 0.999, which every white surface is clamped to; 1 − ρ errs by 1.5e-4 of itself at
// ρ = 0.99, where even steps would err by 8e-4.
RADIVOX_CONST float kMostAlbedo = 0.999f;
RADIVOX_FUNCTION uint encodeAlbedoChannel(float albedo) {
  RADIVOX_PRECISE float squared = 1.0f - clamp(albedo, 0.0f, kMostAlbedo) * (1.0f / kMostAlbedo);
  if (!(squared > 1e-12f)) return 65535u;
  RADIVOX_PRECISE float t = squared * preciseInverseSqrt(squared);
  RADIVOX_PRECISE float rounded = floor(min(t, 1.0f) * 65535.0f + 0.5f);
  return 65535u - uint(rounded);
}
RADIVOX_FUNCTION float decodeAlbedoChannel(uint code) {
  if (code == 0u) return 0.0f;
  RADIVOX_PRECISE float t = float(65535u - code) * (1.0f / 65535.0f);
  RADIVOX_PRECISE float albedo = kMostAlbedo * (1.0f - t * t);
  return albedo;
}
RADIVOX_FUNCTION uvec2 encodeAlbedo(vec3 albedo) {
  return uvec2(encodeAlbedoChannel(albedo.x) | encodeAlbedoChannel(albedo.y) << 16, encodeAlbedoChannel(albedo.z));
}
RADIVOX_FUNCTION vec3 decodeAlbedo(uvec2 code) {
  return vec3(decodeAlbedoChannel(code.x & 0xffffu), decodeAlbedoChannel(code.x >> 16), decodeAlbedoChannel(code.y & 0xffffu));
}

// Where in its voxel a face's surface ends, seen along the face's axis k: how many sixteenths of the voxel are free of it at the low and the
// high end of axis u = (k + 1) % 3, and of v = (k + 2) % 3: low u | high u << 4 | low v << 8 | high v << 12. 0: it may be anywhere.
RADIVOX_CONST uint kMarginSteps = 16u;
RADIVOX_FUNCTION uint faceMargins(Face face) { return face.albedo.y >> 16; }
RADIVOX_FUNCTION uvec2 withMargins(uvec2 albedo, uint margins) { return uvec2(albedo.x, (albedo.y & 0xffffu) | margins << 16); }

// Metres (relative to Scene::origin) → grid space: the one expression that every stage uses.
RADIVOX_FUNCTION vec3 toGridSpace(Grid g, vec3 position) {
  RADIVOX_PRECISE vec3 offset = position - g.origin;
  RADIVOX_PRECISE vec3 p = offset * g.inverseH;
  return p;
}

// x_s of a face in grid space, from the voxel's coordinate.
RADIVOX_FUNCTION vec3 facePosition(Face face, uvec3 voxel) {
  RADIVOX_PRECISE vec3 p = vec3(voxel) + decodePosition(face.position);
  return p;
}

RADIVOX_SHARED_END
#endif
