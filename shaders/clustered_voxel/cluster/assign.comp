#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One group a seed cell: collects the seeds of the 27 cells around it, then each of its faces takes the nearest one that accepts it.
// Ties go to the lower seed. No atomics decide anything. Seeds are sorted by the dominant direction of their normals, and faces pass
// over directions in which no seed can accept them. A face whose seed did not move has seen all others that did not move before, and
// looks at those that moved. Faces that change hands change both seeds' sums.
#define RADIVOX_BIND_HOMES 12
#define RADIVOX_BIND_MOMENTS 13
#define RADIVOX_BIND_POSITIONS 14
#include "clustered_voxel/cluster/seed_sums.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 2, scalar) readonly buffer Keys { uint slotKeys[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Cells { uint slotCells[]; };
layout(set = 0, binding = 4, scalar) readonly buffer CellKeys { uint cellKeys[]; };
layout(set = 0, binding = 5, scalar) readonly buffer CellMasks { uint cellMasks[]; };
layout(set = 0, binding = 6, scalar) readonly buffer FirstSeeds { uint firstSeeds[]; };
layout(set = 0, binding = 7, scalar) readonly buffer SeedStarts { uint seedStarts[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Sorted { uint sorted[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Seeds { Seed seeds[]; };
layout(set = 0, binding = 10, scalar) buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 11, scalar) buffer Control { ClusterControl control; };

const uint kCells = 27u;
const uint kKinds = 2u * kFaceCount;  // 2f: direction f, moved; 2f + 1: not
shared Seed near[kCells * kFaceCount];
shared uint nearId[kCells * kFaceCount];
shared uint kindEnds[kKinds];  // of the seeds of each kind; counts, then starts before that
shared uint changedHere;

uint kindOf(uint seed) { return dominantDirection(seeds[seed].normal) << 1 | (hasMoved(seed) ? 0u : 1u); }

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

// Could a normal with dominant direction f be within the angle of n? It would have to cross the planes between f and n's other axes.
bool canFace(vec3 n, uint f) {
  float along = (f & 1u) == 0u ? n[f >> 1] : -n[f >> 1];
  vec3 a = abs(n);
  float most = max(a.x, max(a.y, a.z));
  return (most - along) * 0.70710678 <= push.sinAngle + 1e-4;
}

void main() {
  uint cell = radivoxGroupIndex();
  if (cell >= control.cellCount) return;  // the whole group
  uint lane = gl_LocalInvocationID.x;
  if (lane < kKinds) kindEnds[lane] = 0u;
  if (lane == 0u) changedHere = 0u;
  barrier();
  uint first = 0u;
  uint count = 0u;
  if (lane < kCells) {
    ivec3 step = ivec3(lane % 3u, (lane / 3u) % 3u, lane / 9u) - 1;
    uint other = findCell(ivec3(unpackVoxel(cellKeys[cell])) + step);
    if (other != kNone) {
      first = firstSeeds[other];
      count = uint(bitCount(cellMasks[other]));
    }
    for (uint seed = first; seed < first + count; ++seed) atomicAdd(kindEnds[kindOf(seed)], 1u);
  }
  barrier();
  if (lane == 0u) {
    uint sum = 0u;
    for (uint kind = 0; kind < kKinds; ++kind) {
      uint ofKind = kindEnds[kind];
      kindEnds[kind] = sum;
      sum += ofKind;
    }
  }
  barrier();
  for (uint seed = first; seed < first + count; ++seed) {
    uint slot = atomicAdd(kindEnds[kindOf(seed)], 1u);  // starts become ends
    near[slot] = seeds[seed];
    nearId[slot] = seed;
  }
  barrier();
  uint firstSeed = firstSeeds[cell];
  uint end = seedStarts[firstSeed + uint(bitCount(cellMasks[cell]))];
  for (uint i = seedStarts[firstSeed] + lane; i < end; i += kClusterGroup) {
    uint s = sorted[i];
    Face face = faceAt(s);
    uvec3 voxel = voxelCoordinate(face.key >> 3);
    vec3 position = facePosition(face, voxel);
    vec3 normal = decodeNormal(face.normal);
    uint old = seedLabels[s];
    uint best = kNone;
    float bestDistance = 0.0;
    uint kindsToSee = 1u;
    if (old != kNone) {
      if (hasMoved(old)) {
        kindsToSee = 2u;
      } else {
        best = old;
        bestDistance = squaredDistance(position, seeds[old], cosineBetween(normal, seeds[old].normal));
      }
    }
    for (uint f = 0; f < kFaceCount; ++f) {
      uint k = f == 0u ? 0u : kindEnds[2u * f - 1u];
      uint stop = canFace(normal, f) ? kindEnds[2u * f + kindsToSee - 1u] : k;
      for (; k < stop; ++k) {
        float cosine = cosineBetween(normal, near[k].normal);
        float d = squaredDistance(position, near[k], cosine);
        bool isBetter = best == kNone || d < bestDistance || (d == bestDistance && nearId[k] < best);
        if (cosine >= push.cosAngle && isBetter) {
          best = nearId[k];
          bestDistance = d;
        }
      }
    }
    if (best != old) {
      atomicAdd(changedHere, 1u);
      seedLabels[s] = best;
      if (old != kNone) addMember(old, face, voxel, normal, -1);
      if (best != kNone) addMember(best, face, voxel, normal, 1);
    }
  }
  barrier();
  if (lane == 0u && changedHere > 0u) atomicAdd(control.changed, changedHere);
}
