#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Largest radiance of any material, as bits: floats from 0 up are ordered as their bits are.
#include "shared/dispatch.glsl"
#include "shared/scene.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 1, scalar) buffer EmissionPeak { uint emissionPeak; };
layout(push_constant, scalar) uniform Push { uint materialCount; };

void main() {
  uint material = radivoxItemIndex();
  if (material >= materialCount) return;
  vec3 emission = materials[material].emission;
  float peak = max(emission.x, max(emission.y, emission.z));
  if (peak > 0.0) atomicMax(emissionPeak, floatBitsToUint(peak));
}
