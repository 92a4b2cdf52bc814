#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a listed face: E_s = Σ over its visibility row. See modules/clustered_voxel/gather/gather.h.
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/voxel_codec.h"
#include "shared/visibility_rows.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kEstimator = 0;  // Gather::Estimator
layout(constant_id = 1) const bool kError = false;  // the standard error is wanted

layout(set = 0, binding = 0, scalar) readonly buffer ListBuffer { uint list[]; };
layout(set = 0, binding = 1, scalar) readonly buffer StatusBuffer { uint status[]; };
layout(set = 0, binding = 2, scalar) readonly buffer RowStartBuffer { uint rowStart[]; };
layout(set = 0, binding = 3, scalar) readonly buffer ChunkBuffer { uvec2 chunkTable[]; };
layout(set = 0, binding = 4, scalar) readonly buffer PlaceBuffer { ClusterPlace places[]; };
layout(set = 0, binding = 5, scalar) readonly buffer ClusterRadiosityBuffer { vec3 clusterRadiosity[]; };
layout(set = 0, binding = 6, scalar) readonly buffer FaceRadiosityBuffer { vec3 faceRadiosity[]; };
layout(set = 0, binding = 7, scalar) readonly buffer FacesBuffer { Face faces[]; };
layout(set = 0, binding = 8, scalar) readonly buffer VoxelBuffer { uint voxels[]; };
layout(set = 0, binding = 9, scalar) buffer IrradianceBuffer { vec4 irradiance[]; };
layout(set = 0, binding = 10, scalar) writeonly buffer ErrorBuffer { vec3 standardError[]; };
layout(constant_id = 2) const bool kSky = false;  // the sky has an image
layout(set = 0, binding = 11, scalar) readonly buffer SkyBuffer { vec3 sky[]; };  // kSkyBinCount means
layout(set = 0, binding = 12, scalar) readonly buffer Info { SceneInfo info; };
layout(set = 0, binding = 13, scalar) buffer SkyIrradianceBuffer { vec4 skyIrradiance[]; };
layout(constant_id = 3) const bool kEmitted = false;  // emitters light by rays
layout(set = 0, binding = 14, scalar) readonly buffer Emission { vec3 emission[]; };
layout(set = 0, binding = 15, scalar) readonly buffer ClusterEmission { vec3 clusterEmission[]; };
layout(set = 0, binding = 16, scalar) writeonly buffer EmittedBuffer { vec4 emitted[]; };
layout(push_constant, scalar) uniform Push {
  uint clusterCount;
  uint faceCount;
};

// The paper's form factor to a patch: cosθ cosθ' A / (π d²), every distance in voxel edges.
float differentialFormFactor(vec3 x, vec3 n, vec3 y, vec3 m, float area) {
  vec3 d = y - x;
  float d2 = dot(d, d);
  if (!(d2 > 0.0)) return 0.0;
  return max(0.0, dot(n, d)) * max(0.0, -dot(m, d)) * area / (3.14159265 * d2 * d2);
}

void main() {
  uint i = radivoxItemIndex();
  if (i >= status[0]) return;
  uint s = list[i];
  VisibilityRow row = openRow(chunkTable[s / kRowsPerChunk], rowStart[rowSlot(s)], rowStart[rowSlot(s) + 1]);
  vec3 sum = vec3(0.0);
  vec3 squares = vec3(0.0);
  vec3 skySum = vec3(0.0), emittedSum = vec3(0.0);
  uint rays = 0, misses = 0;
  // differential: the receiver is the voxel face's centre and axis
  uint f = faces[s].key & 7u;
  vec3 axis = vec3(0.0);
  axis[f >> 1] = (f & 1u) != 0u ? -1.0 : 1.0;
  vec3 x = vec3(ivec3(unpackVoxel(voxels[faces[s].key >> 3]))) + 0.5 + 0.5 * axis;
  while (hasEntry(row)) {
    uint word = nextEntry(row, clusterCount + faceCount);
    uint id = word & kEntryIdMask;
    uint count = (word >> 24) + 1;
    rays += count;
    if (id >= kMissBase) {
      if (id < kAbsorbed) {
        misses += count;
        if (kSky) skySum += float(count) * sky[id - kMissBase];
      }
      continue;
    }
    float weight = float(count);
    vec3 b;
    if (id < clusterCount) {
      b = clusterRadiosity[id];
      if (kEstimator == 1)
        weight = differentialFormFactor(x, axis, places[id].position, places[id].normal, places[id].area);
    } else {
      uint t = id - clusterCount;
      b = faceRadiosity[t];
      if (kEstimator == 1) {
        vec3 y = vec3(ivec3(unpackVoxel(voxels[faces[t].key >> 3]))) + decodePosition(faces[t].position);
        weight = differentialFormFactor(x, axis, y, decodeNormal(faces[t].normal), faces[t].area);
      }
    }
    sum += weight * b;
    if (kEmitted) emittedSum += float(count) * (id < clusterCount ? clusterEmission[id] : emission[id - clusterCount]);
    if (kError) squares += weight * b * b;
  }
  float share = rays > 0u ? 1.0 / float(rays) : 0.0;
  irradiance[s] = vec4(kEstimator == 1 ? sum : sum * share, float(misses) * share);
  if (kSky) skyIrradiance[s] = vec4(3.14159265358979 * share * (skySum + float(misses) * info.skyRadiance), 0.0);
  if (kEmitted) emitted[s] = vec4(share * emittedSum, 0.0);
  if (kError) {
    // Of the mean of M independent rays: √((mean of squares − square of the mean) / (M − 1)).
    vec3 mean = sum * share;
    standardError[s] = rays > 1u ? sqrt(max(squares * share - mean * mean, vec3(0.0)) / float(rays - 1u)) : vec3(0.0);
  }
}
