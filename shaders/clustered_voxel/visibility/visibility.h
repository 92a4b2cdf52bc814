// What the shaders of clustered_voxel.visibility and their host side agree on.
#ifndef RADIVOX_CLUSTERED_VOXEL_VISIBILITY_H
#define RADIVOX_CLUSTERED_VOXEL_VISIBILITY_H
#include "../../shared/sky.h"
#include "../../shared/voxel_codec.h"
RADIVOX_SHARED_BEGIN

// Shifts of the direction set; a face takes one by its seed, so that neighbours do not share a pattern.
RADIVOX_CONST uint kShiftCount = 16u;
// Rays that one lane traces, one after the other.
RADIVOX_CONST uint kRaysPerLane = 32u;  // a word of bits

// What a ray hit, as the trace leaves it for the merge: a face, with kNearHit if it keeps its id and kCloseHit if it does not count for the
// face's weight; or kMissHit + bin (kSkyBinCount: absorbed).
RADIVOX_CONST uint kNearHit = 0x80000000u;
RADIVOX_CONST uint kCloseHit = 0x40000000u;
RADIVOX_CONST uint kHitFace = 0x3fffffffu;
RADIVOX_CONST float kCloseDistance = 2.0f;  // voxels: surfaces that pass through each other see one another nearer than this, and nobody sees them
// Weight of a ray: the area of the face it comes from, in parts of h². With these a face that every ray of its size finds has 128 · 64 · a_s.
RADIVOX_CONST float kAreaUnits = 64.0f;
RADIVOX_CONST uint kMostWeight = 0xff000000u;
RADIVOX_CONST uint kMissHit = 0x7fffff00u;
// Rays that are still to be traced: bits, rayWords(M) words a row.
RADIVOX_FUNCTION uint rayWords(uint rayCount) { return (rayCount + 31u) >> 5; }
RADIVOX_FUNCTION uint rayBits(uint rayCount, uint first) { return rayCount - first >= 32u ? 0xffffffffu : (1u << (rayCount - first)) - 1u; }
RADIVOX_CONST uint kEmptySlot = 0xffffffffu;

RADIVOX_FUNCTION uint hashBits(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
// What a face draws its random numbers from: its place, so that they stay when other faces come and go. voxel: packed coordinate.
RADIVOX_FUNCTION uint faceSeed(uint voxel, uint f) { return hashBits(voxel + f * 0x9e3779b9u); }
RADIVOX_FUNCTION uint shiftOf(uint seed) { return hashBits(seed) % kShiftCount; }
RADIVOX_FUNCTION uint rayRandom(uint seed, uint ray) { return hashBits(seed * kMaxRays + ray + 0x9e3779b9u); }

// A direction of the upper hemisphere ↔ its place on the unit disc, unorm16 × 2: a word each, so that kShiftCount · kMaxRays of them
// fit the smallest uniform buffer that a device may have.
RADIVOX_FUNCTION vec3 decodeDirection(uint code) {
  RADIVOX_PRECISE float x = float(code & 0xffffu) * (2.0f / 65535.0f) - 1.0f;
  RADIVOX_PRECISE float y = float(code >> 16) * (2.0f / 65535.0f) - 1.0f;
  RADIVOX_PRECISE float squared = max(1.0f - x * x - y * y, 1e-8f);
  RADIVOX_PRECISE float z = squared * preciseInverseSqrt(squared);
  return vec3(x, y, z);
}

// Local direction (z along n) into the frame of n; the two other axes after Duff et al., "Building an Orthonormal Basis, Revisited" (2017).
RADIVOX_FUNCTION vec3 alongNormal(vec3 local, vec3 n) {
  float side = n.z >= 0.0f ? 1.0f : -1.0f;
  RADIVOX_PRECISE float a = preciseReciprocal(1.0f + abs(n.z));
  RADIVOX_PRECISE float b = n.x * n.y * a;
  RADIVOX_PRECISE float tx = 1.0f - n.x * n.x * a;
  RADIVOX_PRECISE float by = 1.0f - n.y * n.y * a;
  RADIVOX_PRECISE float x = tx * local.x - side * b * local.y + n.x * local.z;
  RADIVOX_PRECISE float y = -b * local.x + side * by * local.y + n.y * local.z;
  RADIVOX_PRECISE float z = -side * n.x * local.x - n.y * local.y + n.z * local.z;
  return vec3(x, y, z);
}

// Where the rays of a face start (frame=normal): x_s, lifted a little.
RADIVOX_FUNCTION vec3 liftedOrigin(vec3 position, vec3 n) {
  RADIVOX_PRECISE vec3 lifted = position + 0.05f * n;
  return lifted;
}

RADIVOX_SHARED_END
#endif
