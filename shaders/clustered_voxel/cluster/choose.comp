#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Each small piece looks for the touching piece that suits its faces best: least Σ D² to that piece's seed, which must accept them all. Ties go to
// the lower piece; pieces with a wall between do not touch. A piece that orphans founded has its lowest face for a seed.
#include "clustered_voxel/cluster/cluster_common.glsl"
#include "clustered_voxel/structure.glsl"
#include "clustered_voxel/cluster/apart.glsl"
layout(local_size_x = kClusterGroup) in;
layout(set = 0, binding = 6, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 7, scalar) readonly buffer SeedLabels { uint seedLabels[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Seeds { Seed seeds[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Pieces { uint pieces[]; };
layout(set = 0, binding = 10, scalar) readonly buffer Small { uint small[]; };
layout(set = 0, binding = 11, scalar) writeonly buffer Targets { uint targets[]; };

Seed seedOf(uint piece) {
  uint label = seedLabels[piece];
  if (label != kNone) return seeds[label];
  Face face = faceAt(piece);
  return Seed(facePosition(face, unpackVoxel(voxels[face.key >> 3])), decodeNormal(face.normal));
}

// Small pieces are few: the group's first lanes take them, so that others do not wait on each.
shared uint work[kClusterGroup];
shared uint workCount;

void main() {
  uint item = radivoxItemIndex();
  if (gl_LocalInvocationID.x == 0u) workCount = 0u;
  barrier();
  if (item < push.faceCount) {
    if (pieces[item] == item && small[4u * item] <= push.mergeLimit)
      work[atomicAdd(workCount, 1u)] = item;
    else
      targets[item] = kNone;
  }
  barrier();
  if (gl_LocalInvocationID.x < workCount) {
    uint piece = work[gl_LocalInvocationID.x];
    uint size = small[4u * piece];
    uint target = kNone;
    vec3 position[kMostMergeFaces];
    vec3 normal[kMostMergeFaces];
    ivec3 coordinate[kMostMergeFaces];
    uint members[kMostMergeFaces];
    for (uint i = 0; i < size; ++i) {
      // By face id, so that the sum below has one order: members came in any.
      uint member = kNone;
      for (uint k = 0; k < size; ++k) {
        uint candidate = small[4u * piece + 1u + k];
        uint lower = 0u;
        for (uint l = 0; l < size; ++l)
          if (small[4u * piece + 1u + l] < candidate) lower += 1u;
        if (lower == i) member = candidate;
      }
      Face face = faceAt(member);
      uvec3 voxel = unpackVoxel(voxels[face.key >> 3]);
      position[i] = facePosition(face, voxel);
      normal[i] = decodeNormal(face.normal);
      coordinate[i] = ivec3(voxel);
      members[i] = member;
    }
    float bestDistance = 0.0;
    uint last = kNone;
    for (uint i = 0; i < size; ++i) {
      for (uint step = 0; step < 27u; ++step) {
        ivec3 otherCoordinate = coordinate[i] + ivec3(step % 3u, (step / 3u) % 3u, step / 9u) - 1;
        uint other = voxelIndex(otherCoordinate);
        if (other == kNone) continue;
        uint begin = firstFace(other);
        uint end = begin + uint(bitCount(faceMask(other)));
        for (uint b = begin; b < end; ++b) {
          uint candidate = pieces[b];
          if (candidate == piece || candidate == last || candidate == target) continue;
          Seed seed = seedOf(candidate);
          precise float distance = 0.0;
          bool accepted = true;
          for (uint j = 0; j < size; ++j) {
            float cosine = cosineBetween(normal[j], seed.normal);
            if (cosine < push.cosAngle) accepted = false;
            distance = distance + squaredDistance(position[j], seed, cosine);
          }
          bool better = target == kNone || distance < bestDistance || (distance == bestDistance && candidate < target);
          if (accepted && better) {
            if (areApart(members[i], coordinate[i], b, otherCoordinate)) continue;
            target = candidate;
            bestDistance = distance;
          }
          last = candidate;
        }
      }
    }
    targets[piece] = target;
  }
}
