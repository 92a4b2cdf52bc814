#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Flux sums → irradiance: E_dir = Φ_f / (a_s h²). A voxel shows no more than its own side: area whose projection is beyond h² lies behind other surface
// (sheets upon sheets, surfaces that are there twice), gets no light, and must not dilute what the front gets. Scraps of surface, smaller than a few shadow texels, catch one by chance: they get no more
// than the lights can give, since the rare ray that is sent to such a face would be a spark.
#include "shared/dispatch.glsl"
#include "shared/light.glsl"
#include "shared/voxel_codec.h"
#include "shared/voxel.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer FacesBuffer { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer GridBuffer { Grid grid; };
layout(set = 0, binding = 2, scalar) buffer IrradianceBuffer { uint irradiance[]; };  // RGB a face; low words of the flux, then bits of floats
layout(set = 0, binding = 3, scalar) readonly buffer TableBuffer { uint viewTable[]; };
layout(set = 0, binding = 4, scalar) readonly buffer FluxHighBuffer { uint fluxHigh[]; };
layout(set = 0, binding = 5, scalar) readonly buffer LightBuffer { Light lights[]; };
layout(set = 0, binding = 6, scalar) readonly buffer VoxelBuffer { uint voxels[]; };
layout(push_constant, scalar) uniform Push {
  uint faceCount;
  uint lightCount;
};

const float kScrap = 0.05;  // h²

// Irradiance of a plane about the face that is turned to each light.
vec3 mostIrradiance(Face face) {
  vec3 x = grid.origin + (vec3(unpackVoxel(voxels[face.key >> 3])) + decodePosition(face.position)) * grid.h;
  vec3 sum = vec3(0.0);
  for (uint l = 0; l < lightCount; ++l) {
    vec3 toLight = lights[l].type == kLightDirectional ? -lights[l].direction : lights[l].position - x;
    float squared = dot(toLight, toLight);
    if (squared > 0.0) sum += lightIrradiance(lights[l], x, toLight * inversesqrt(squared));
  }
  return sum;
}

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  int exponent = int(viewTable[0]);
  // Of surface that belongs to one face, as much as projects to the voxel's side. (0.57: what looks along an axis the most does so by 1/√3 at least.)
  float most = grid.dominant != 0u ? 1.0 / max(abs(decodeNormal(faces[s].normal)[(faces[s].key & 7u) >> 1]), 0.57) : 1.0;
  float area = min(faces[s].area, most) * grid.h * grid.h;
  vec3 sum;
  for (uint c = 0; c < 3; ++c)
    sum[c] = ldexp(float(fluxHigh[3 * s + c]), 32 - exponent) + ldexp(float(irradiance[3 * s + c]), -exponent);
  sum /= area;
  if (faces[s].area < kScrap) sum = min(sum, mostIrradiance(faces[s]));
  for (uint c = 0; c < 3; ++c) irradiance[3 * s + c] = floatBitsToUint(sum[c]);
}
