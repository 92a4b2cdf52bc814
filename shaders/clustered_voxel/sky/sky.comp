#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a face: E_sky = Σ (m/M) π L over the misses of its visibility row. See modules/clustered_voxel/sky/sky.h.
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/visibility_rows.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kImage = false;

layout(set = 0, binding = 0, scalar) readonly buffer RowStartBuffer { uint rowStart[]; };
layout(set = 0, binding = 1, scalar) readonly buffer ChunkBuffer { uvec2 chunkTable[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Info { SceneInfo info; };
layout(set = 0, binding = 3, scalar) writeonly buffer IrradianceBuffer { vec3 irradiance[]; };
layout(set = 0, binding = 4, scalar) readonly buffer SkyBuffer { vec3 sky[]; };  // kSkyBinCount means
layout(push_constant, scalar) uniform Push {
  uint faceCount;
  uint clusterCount;
};

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  uint slot = rowSlot(s);
  VisibilityRow row = openRow(chunkTable[s / kRowsPerChunk], rowStart[slot], rowStart[slot + 1u]);
  uint rays = 0u, misses = 0u;
  vec3 sum = vec3(0.0);
  while (hasEntry(row)) {
    uint word = nextEntry(row, clusterCount + faceCount);
    uint id = word & kEntryIdMask;
    uint count = (word >> 24) + 1u;
    rays += count;
    if (id < kMissBase || id >= kAbsorbed) continue;
    misses += count;
    if (kImage) sum += float(count) * sky[id - kMissBase];
  }
  sum += float(misses) * info.skyRadiance;
  irradiance[s] = rays > 0u ? 3.14159265358979 / float(rays) * sum : vec3(0.0);
}
