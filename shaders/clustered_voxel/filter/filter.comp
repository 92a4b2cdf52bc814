#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a face: weighted mean over the same-direction faces about it. See modules/clustered_voxel/filter/filter.h.
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kWeights = 0;  // Filter::Weights

layout(set = 0, binding = 6, scalar) readonly buffer VoxelBuffer { uint voxels[]; };
layout(set = 0, binding = 7, scalar) readonly buffer NeededBuffer { uint needed[]; };
layout(set = 0, binding = 8, scalar) readonly buffer ListBuffer { uint list[]; };
layout(set = 0, binding = 9, scalar) readonly buffer StatusBuffer { uint status[]; };
layout(set = 0, binding = 10, scalar) readonly buffer FromBuffer { vec4 from[]; };
layout(set = 0, binding = 11, scalar) writeonly buffer ToBuffer { vec4 to[]; };
layout(push_constant, scalar) uniform Push {
  uint faceCount;
  uint radius;
  uint fromList;
};
#include "clustered_voxel/walls.glsl"

bool isNeeded(uint s) { return (needed[s >> 5] & (1u << (s & 31u))) != 0u; }

// No wall on the way: the last voxel before the far one is asked too, so that reaches of two or more voxels do not jump a wall.
bool blocked(ivec3 a, uint av, vec3 x, ivec3 b, uint bv, vec3 y, ivec3 ahead) {
  if (wallBetween(a, av, x, b, bv, y, ahead)) return true;
  ivec3 delta = b - a;
  int steps = max(abs(delta.x), max(abs(delta.y), abs(delta.z)));
  for (int i = 1; i < steps; ++i) {
    ivec3 c = ivec3(floor(mix(x, y, float(i) / float(steps))));
    uint cv = voxelIndex(c);
    if (cv != kNone && wallBetween(c, cv, x, c, cv, y, ahead)) return true;
  }
  return false;
}

void main() {
  uint i = radivoxItemIndex();
  uint s = i;
  if (fromList != 0u) {
    if (i >= status[0]) return;
    s = list[i];
  } else if (i >= faceCount || !isNeeded(s)) {
    return;
  }
  if (radius == 0u) {
    to[s] = from[s];
    return;
  }
  uint key = faceAt(s).key;
  ivec3 coord = ivec3(unpackVoxel(voxels[key >> 3]));
  vec3 x = vec3(coord) + decodePosition(faceAt(s).position);
  vec3 n = decodeNormal(faceAt(s).normal);
  ivec3 ahead = stepAhead(n);
  int r = int(radius);
  float sigma = 0.5 * float(r) + 0.25;
  vec4 sum = vec4(0.0);
  float total = 0.0;
  for (int dz = -r; dz <= r; ++dz)
    for (int dy = -r; dy <= r; ++dy)
      for (int dx = -r; dx <= r; ++dx) {
        ivec3 there = coord + ivec3(dx, dy, dz);
        uint voxel = voxelIndex(there);
        if (voxel == kNone) continue;
        uint t = faceIndex(voxel, key & 7u);
        if (t == kNone || !isNeeded(t)) continue;
        float d2 = float(dx * dx + dy * dy + dz * dz);
        float weight = exp(-d2 / (2.0 * sigma * sigma));
        vec4 value = from[t];
        if (kWeights == 1) {
          if (max(value.x, max(value.y, value.z)) == 0.0) continue;  // the paper drops unlit faces
        } else if (t != s) {
          vec3 y = vec3(there) + decodePosition(faceAt(t).position);
          vec3 m = decodeNormal(faceAt(t).normal);
          float offPlane = max(abs(dot(y - x, n)), abs(dot(y - x, m)));
          weight *= max(0.0, dot(n, m) * 4.0 - 3.0) * max(0.0, 1.0 - offPlane * offPlane) * min(1.0, faceAt(t).area);
          if (weight <= 0.0 || blocked(coord, key >> 3, x, there, voxel, y, ahead)) continue;
        } else {
          weight *= min(1.0, faceAt(s).area) + 1e-3;
        }
        sum += weight * value;
        total += weight;
      }
  to[s] = total > 0.0 ? sum / total : from[s];
}
