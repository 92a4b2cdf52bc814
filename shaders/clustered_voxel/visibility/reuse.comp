#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// A lane up to 32 rays of a face: those that pass no voxel which has changed hit what they hit in the run before; bits say which are to be traced.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "clustered_voxel/visibility/kept_hits.glsl"
#define RADIVOX_TRACE_MORE KeptHits old; uint boxCount;
#include "clustered_voxel/visibility/trace.glsl"
layout(set = 0, binding = 11, scalar) writeonly buffer Hits { uint hits[]; };  // M a row
layout(set = 0, binding = 22, scalar) writeonly buffer Todo { uint todo[]; };  // rayWords(M) a row
layout(set = 0, binding = 23, scalar) readonly buffer OldFaces { uint oldFaces[]; };
layout(set = 0, binding = 24, scalar) readonly buffer Boxes { ChangedBox boxes[kMostChangedBoxes]; };
layout(set = 0, binding = 25, scalar) buffer TracedCount { uint tracedCount; };

const float kEndless = 4096.0;  // voxels: past any grid

// The way from `from` along `way`, which is as long as it is, through a box and the margin around it.
bool passesChange(vec3 from, vec3 way) {
  vec3 inverse = 1.0 / mix(way, vec3(1e-6), lessThan(abs(way), vec3(1e-6)));
  bool passes = false;
  for (uint b = 0u; b < boxCount; ++b) {
    vec3 toLow = (boxes[b].least - kChangedMargin - from) * inverse;
    vec3 toHigh = (boxes[b].greatest + 1.0 + kChangedMargin - from) * inverse;
    vec3 enters = min(toLow, toHigh), leaves = max(toLow, toHigh);
    float enter = max(max(enters.x, enters.y), max(enters.z, 0.0));
    float leave = min(min(leaves.x, leaves.y), min(leaves.z, 1.0));
    passes = passes || enter <= leave;
  }
  return passes;
}

void main() {
  uint words = rayWords(rayCount);
  uint item = radivoxItemIndex();
  uint row = item / words;
  if (row >= rowCount) return;
  uint first = 32u * (item % words);
  uint s = firstFace + row;
  uint left = rayBits(rayCount, first);
  uint was = oldFaces[s];
  if (was != kNone) {
    castBegin();
    vec3 middle = vec3(voxelCoordinate(faceAt(s).key >> 3)) + 0.5;
    bool started = false;
    Start start;
    for (uint ray = first; ray < min(first + 32u, rayCount); ++ray) {
      uint hit = keptWord(old, keptHit(old, was, rayCount, ray));
      bool met = (hit & kNearHit) != 0u || hit < kMissHit;
      vec3 from = middle;
      vec3 way = vec3(0.0);
      if (met) {
        uint face = keptWord(old, keptFace(old, hit & kHitFace));
        if (face == kNone) continue;
        way = vec3(voxelCoordinate(faceAt(face).key >> 3)) + 0.5 - middle;
        hit = (hit & ~kHitFace) | face;
      } else {  // how far it went is not kept
        if (!started) start = startOf(s);
        started = true;
        vec3 about = start.normal;
        uint own;
        way = kEndless * (kNear ? rayFromPiece(start, ray, about, own).direction
                                : alongNormal(decodeDirection(directions[start.directions + ray]), about));
      }
      if (passesChange(from, way)) continue;
      hits[row * rayCount + ray] = hit;
      left &= ~(1u << (ray - first));
    }
  }
  todo[item] = left;
  if (left != 0u) atomicAdd(tracedCount, uint(bitCount(left)));
}
