#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The planes of each voxel's surface (shared/voxel_plane.h), in two runs: how many, then what.
layout(local_size_x = 64) in;
#define RADIVOX_BIND_FACE_MASK 0
#define RADIVOX_BIND_FIRST_FACE 1
#define RADIVOX_BIND_FACES 2
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"
#include "shared/voxel_plane.h"
layout(constant_id = 0) const bool kCount = false;  // only how many planes beyond the first each voxel has
layout(set = 0, binding = 3, scalar) writeonly buffer Planes { uvec2 planes[]; };
layout(set = 0, binding = 4, scalar) buffer Extras { uint planeExtras[]; };  // counts, then their exclusive sums
layout(push_constant, scalar) uniform Push { uint voxelCount; };

float dotPrecise(vec3 a, vec3 b) {
  precise float two = a.x * b.x + a.y * b.y;
  precise float three = two + a.z * b.z;
  return three;
}

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= voxelCount) return;
  uint first = firstFace(voxel);
  uint mask = faceMask(voxel);
  if (!kCount && mask == 0u) planes[voxel] = uvec2(0u);
  uint left = mask;
  uint count = 0u;
  for (; left != 0u; ++count) {
    uint founder = kNone;
    Face largest;
    for (uint f = 0u; f < kFaceCount; ++f) {
      if (((left >> f) & 1u) == 0u) continue;
      Face face = faceAt(first + uint(bitCount(mask & ((1u << f) - 1u))));
      if (founder != kNone && face.area <= largest.area) continue;
      founder = f;
      largest = face;
    }
    vec3 n = decodeNormal(largest.normal);
    vec3 x = decodePosition(largest.position);
    uint members = 1u << founder;
    for (uint f = 0u; f < kFaceCount; ++f) {
      if (((left >> f) & 1u) == 0u) continue;
      Face face = faceAt(first + uint(bitCount(mask & ((1u << f) - 1u))));
      precise vec3 offset = decodePosition(face.position) - x;
      bool agrees = abs(dotPrecise(decodeNormal(face.normal), n)) > kSamePlaneCosine && abs(dotPrecise(offset, n)) < kSamePlaneDistance;
      members |= agrees ? 1u << f : 0u;
    }
    left &= ~members;
    if (kCount) continue;
    // What is made of backs is on the plane, but no surface that shows there.
    for (uint f = 0u; f < kFaceCount; ++f) {
      if (((members >> f) & 1u) == 0u) continue;
      Face face = faceAt(first + uint(bitCount(mask & ((1u << f) - 1u))));
      members &= (face.position & kMadeOfBacks) != 0u ? ~(1u << f) : ~0u;
    }
    uint code = planeNormalCode(largest.normal);
    uint offset = encodePlaneOffset(planeNormal(code), x);
    uint axis = (largest.key & 7u) >> 1;
    uvec2 plane = uvec2(code | members << 20 | mask << 26, offset | faceMargins(largest) << 13 | axis << 29 | (left != 0u ? kPlaneMore : 0u));
    planes[count == 0u ? voxel : voxelCount + planeExtras[voxel] + count - 1u] = plane;
  }
  if (kCount) planeExtras[voxel] = max(count, 1u) - 1u;
}
