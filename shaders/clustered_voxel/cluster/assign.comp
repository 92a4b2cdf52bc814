#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One group a seed cell: collects the seeds of the 27 cells around it, then each of its faces takes the nearest one that accepts it.
// Ties go to the lower seed. No atomics decide anything.
#include "clustered_voxel/cluster/cluster_common.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 2, scalar) readonly buffer Keys { uint slotKeys[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Cells { uint slotCells[]; };
layout(set = 0, binding = 4, scalar) readonly buffer CellKeys { uint cellKeys[]; };
layout(set = 0, binding = 5, scalar) readonly buffer CellStarts { uint cellStarts[]; };
layout(set = 0, binding = 6, scalar) readonly buffer CellMasks { uint cellMasks[]; };
layout(set = 0, binding = 7, scalar) readonly buffer FirstSeeds { uint firstSeeds[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Sorted { uint sorted[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Seeds { Seed seeds[]; };
layout(set = 0, binding = 10, scalar) buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 11, scalar) buffer Control { ClusterControl control; };

const uint kCells = 27u;
shared uint cellFirst[kCells];
shared uint cellSeeds[kCells];
shared Seed near[kCells * kFaceCount];
shared uint nearId[kCells * kFaceCount];
shared uint changedHere;

uint findCell(ivec3 coordinate) {
  // Cells beyond the packed range hold nothing; those beyond the grid are not in the table.
  if (any(lessThan(coordinate, ivec3(0))) || any(greaterThan(coordinate, ivec3(1023)))) return kNone;
  uint key = packVoxel(uvec3(coordinate));
  uint slot = firstSlot(key);
  for (uint probe = 0; probe < push.hashSize; ++probe) {
    uint found = slotKeys[slot];
    if (found == key) return slotCells[slot];
    if (found == kNone) return kNone;
    slot = nextSlot(slot);
  }
  return kNone;
}

void main() {
  uint cell = radivoxGroupIndex();
  if (cell >= control.cellCount) return;  // the whole group
  uint lane = gl_LocalInvocationID.x;
  if (lane == 0u) changedHere = 0u;
  if (lane < kCells) {
    ivec3 step = ivec3(lane % 3u, (lane / 3u) % 3u, lane / 9u) - 1;
    uint other = findCell(ivec3(unpackVoxel(cellKeys[cell])) + step);
    cellFirst[lane] = other == kNone ? 0u : firstSeeds[other];
    cellSeeds[lane] = other == kNone ? 0u : uint(bitCount(cellMasks[other]));
  }
  barrier();
  uint nearCount = 0u;
  uint slot = 0u;
  for (uint k = 0; k < kCells; ++k) {
    if (k == lane) slot = nearCount;
    nearCount += cellSeeds[k];
  }
  if (lane < kCells) {
    for (uint k = 0; k < cellSeeds[lane]; ++k) {
      near[slot + k] = seeds[cellFirst[lane] + k];
      nearId[slot + k] = cellFirst[lane] + k;
    }
  }
  barrier();
  uint end = cellStarts[cell + 1u];
  for (uint i = cellStarts[cell] + lane; i < end; i += kClusterGroup) {
    uint s = sorted[i];
    Face face = faces[s];
    vec3 position = facePosition(face, voxelCoordinate(face.key >> 3));
    vec3 normal = decodeNormal(face.normal);
    uint best = kNone;
    float bestDistance = 0.0;
    for (uint k = 0; k < nearCount; ++k) {
      float cosine = cosineBetween(normal, near[k].normal);
      if (cosine < push.cosAngle) continue;
      float d = squaredDistance(position, near[k], cosine);
      if (best == kNone || d < bestDistance || (d == bestDistance && nearId[k] < best)) {
        best = nearId[k];
        bestDistance = d;
      }
    }
    if (seedLabels[s] != best) atomicAdd(changedHere, 1u);
    seedLabels[s] = best;
  }
  barrier();
  if (lane == 0u && changedHere > 0u) atomicAdd(control.changed, changedHere);
}
