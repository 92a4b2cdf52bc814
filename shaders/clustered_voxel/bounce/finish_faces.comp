#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// B_s = ρ_s (E_dir,s + E_emit + E_ind): direct light at the detail of faces; the rest from the face's own rays.
#include "clustered_voxel/bounce/bounce_types.h"
#include "shared/dispatch.glsl"
#include "shared/visibility_rows.glsl"
#include "shared/voxel_codec.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Direct { vec3 faceIrradiance[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Radiosity { vec3 radiosity[]; };
layout(set = 0, binding = 4, scalar) readonly buffer VisibilityRowStart { uint visibilityRowStart[]; };
layout(set = 0, binding = 5, scalar) readonly buffer ChunkTable { uvec2 chunkTable[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Senders { vec3 senders[]; };        // reflected radiosity of clusters, a bounce before
layout(set = 0, binding = 7, scalar) readonly buffer DirectRadiosity { vec3 directRadiosity[]; };
layout(set = 0, binding = 8, scalar) readonly buffer MeanEmission { vec3 meanEmission[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Clusters { Cluster clusters[]; };

// What leaves the surface that an entry of a row names. Nearby it is a face: its direct light is its own, what else it reflects its cluster's.
vec3 radiosityOf(uint id) {
  bool isFace = id >= push.clusterCount;
  if (isFace && id - push.clusterCount >= push.faceCount) return vec3(0.0);  // a miss
  uint face = isFace ? id - push.clusterCount : 0u;
  uint c = isFace ? labels[face] : id;
  vec3 sum = senders[push.senders + c];
  if (isFace) {
    vec3 albedo = clusters[c].albedo;
    vec3 passedOn = max(sum - directRadiosity[c], vec3(0.0)) / max(albedo, vec3(1e-6));
    sum = decodeAlbedo(faces[face].albedo) * (faceIrradiance[face] + passedOn);
  }
  if (push.hasEmission != 0u) sum += meanEmission[c];
  return sum;
}

vec3 rowIrradiance(uint s) {
  uint slot = rowSlot(s);
  VisibilityRow row = openRow(chunkTable[s / kRowsPerChunk], visibilityRowStart[slot], visibilityRowStart[slot + 1u]);
  vec3 sum = vec3(0.0);
  float rays = 0.0;
  while (hasEntry(row)) {
    uint entry = nextEntry(row, push.clusterCount + push.faceCount);
    float count = float((entry >> 24) + 1u);
    sum += count * radiosityOf(entry & kEntryIdMask);
    rays += count;
  }
  return sum / max(rays, 1.0);
}

void main() {
  uint s = radivoxItemIndex();
  if (s >= push.faceCount) return;
  radiosity[s] = decodeAlbedo(faces[s].albedo) * (faceIrradiance[s] + rowIrradiance(s));
}
