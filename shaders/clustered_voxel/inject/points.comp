#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The paper's injection (section 4.4, figure 10): 18 points 1.5 voxels about the voxel's centre are looked up in the shadow map; a voxel whose
// neighbour towards the light is occupied is refused. E_dir = the share of points that see the light × the unshadowed irradiance.
#include "shared/dispatch.glsl"
#include "shared/light.glsl"
#define RADIVOX_BIND_GRID 2
#define RADIVOX_BIND_OCCUPANCY 4
#define RADIVOX_BIND_RANK 5
#define RADIVOX_BIND_VOXELS 6
#define RADIVOX_BIND_FACES 7
#include "shared/voxel_lookup.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer LightBuffer { Light lights[]; };
layout(set = 0, binding = 1, scalar) readonly buffer ViewBuffer { ShadowView views[]; };
layout(set = 0, binding = 3) uniform sampler2DArray shadowDepth;
layout(set = 0, binding = 8, scalar) writeonly buffer IrradianceBuffer { vec3 irradiance[]; };
layout(set = 0, binding = 9, scalar) buffer StatusBuffer { uint status[]; };
layout(push_constant, scalar) uniform Push {
  uint faceCount;
  uint lightCount;
};

// 6 face centres and 12 edge centres of the voxel, as directions.
vec3 pointDirection(uint i) {
  if (i < 6u) return faceVector(i);
  uint e = i - 6u;
  uint k = e >> 2;  // the axis in which the edge's centre is zero
  vec3 d = vec3((e & 1u) == 0u ? 1.0 : -1.0);
  if ((e & 2u) != 0u) d[(k + 1) % 3] = -d[(k + 1) % 3];
  d[k] = 0.0;
  return normalize(d);
}

bool seesLight(Light light, vec3 p) {
  for (uint v = 0; v < light.shadowViewCount; ++v) {
    ShadowView view = views[light.firstShadowView + v];
    vec4 clip = view.viewProjection * vec4(p, 1.0);
    if (!(clip.w > 0.0)) continue;
    vec3 ndc = clip.xyz / clip.w;
    if (any(greaterThan(abs(ndc.xy), vec2(1.0)))) continue;
    if (view.resolution == 0u) return true;  // no face is in it
    uvec2 texel = min(uvec2((ndc.xy * 0.5 + 0.5) * float(view.resolution)), uvec2(view.resolution - 1));
    float stored = texelFetch(shadowDepth, ivec3(view.offsetX + texel.x, view.offsetY + texel.y, view.layer), 0).x;
    return ndc.z >= stored;  // reversed: larger is nearer
  }
  // Outside every view: beyond the scene's bounds for a directional light, which nothing shades; else not lit.
  return light.type == kLightDirectional;
}

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  Face face = faceAt(s);
  ivec3 coord = ivec3(voxelCoordinate(face.key >> 3));
  vec3 centre = vec3(coord) + 0.5;
  vec3 n = decodeNormal(face.normal);
  vec3 x = grid.origin + (vec3(coord) + decodePosition(face.position)) * grid.h;
  vec3 sum = vec3(0.0);
  for (uint l = 0; l < lightCount; ++l) {
    Light light = lights[l];
    vec3 unshadowed = lightIrradiance(light, x, n);
    if (!(max(unshadowed.x, max(unshadowed.y, unshadowed.z)) > 0.0)) continue;
    vec3 toLight = light.type == kLightDirectional ? -light.direction : normalize(light.position - x);
    // The neighbour towards the light, along the dominant axis.
    vec3 a = abs(toLight);
    ivec3 step = ivec3(0);
    int k = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    step[k] = toLight[k] < 0.0 ? -1 : 1;
    if (isOccupied(coord + step)) continue;
    float seen = 0.0;
    for (uint i = 0; i < 18u; ++i)
      seen += seesLight(light, grid.origin + (centre + 1.5 * pointDirection(i)) * grid.h) ? 1.0 / 18.0 : 0.0;
    sum += seen * unshadowed;
  }
  irradiance[s] = sum;
}
