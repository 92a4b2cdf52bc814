#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// A lane an old face: which face is in its place now, and the other way round.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/kept_hits.glsl"
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_FACE_MASK 3
#define RADIVOX_BIND_FIRST_FACE 4
layout(set = 0, binding = 5, scalar) writeonly buffer OldFaces { uint oldFaces[]; };  // of each face now; kNone at first
layout(push_constant, scalar) uniform Push { KeptHits old; };
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

void main() {
  uint face = radivoxItemIndex();
  if (face >= old.faceCount) return;
  uint key = keptWord(old, keptFace(old, face));
  uint voxel = voxelIndex(ivec3(unpackVoxel(keptWord(old, key >> 3))));
  uint here = voxel == kNone ? kNone : faceIndex(voxel, key & 7u);
  KeptWords(old.address).words[keptFace(old, face)] = here;
  if (here != kNone) oldFaces[here] = face;
}
