#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// E_dir of each face with the sky's light.
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kLit = true;  // lamps or emitters have left theirs there

layout(set = 0, binding = 0, scalar) readonly buffer SkyBuffer { vec3 sky[]; };
layout(set = 0, binding = 1, scalar) buffer IrradianceBuffer { vec3 irradiance[]; };
layout(push_constant, scalar) uniform Push { uint faceCount; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  irradiance[s] = sky[s] + (kLit ? irradiance[s] : vec3(0.0));
}
