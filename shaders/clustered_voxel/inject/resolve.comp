#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Flux sums → irradiance: E_dir = Φ_f / (a_s h²).
#include "shared/dispatch.glsl"
#include "shared/voxel.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer FacesBuffer { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer GridBuffer { Grid grid; };
layout(set = 0, binding = 2, scalar) readonly buffer FluxBuffer { uint flux[]; };
layout(set = 0, binding = 3, scalar) readonly buffer TableBuffer { uint viewTable[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer IrradianceBuffer { vec3 irradiance[]; };
layout(push_constant, scalar) uniform Push { uint faceCount; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  int exponent = int(viewTable[0]);
  float area = faces[s].area * grid.h * grid.h;
  vec3 sum;
  for (uint c = 0; c < 3; ++c)
    sum[c] = ldexp(float(flux[6 * s + 2 * c + 1]), 32 - exponent) + ldexp(float(flux[6 * s + 2 * c]), -exponent);
  irradiance[s] = sum / area;
}
