#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// A lane a voxel: keeps its place, a hash of all that rays can meet in it, and its faces' keys. Two hashes of 32 bits that have nothing in common: that
// a change goes unseen has odds of 2^-64.
layout(local_size_x = 64) in;
#include "clustered_voxel/visibility/visibility.h"
#include "clustered_voxel/visibility/kept_hits.glsl"
#include "shared/listed_triangle.h"
#include "shared/scene.h"
#include "shared/voxel_plane.h"
layout(set = 0, binding = 0, scalar) readonly buffer Voxels { uint voxels[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Planes { uvec2 planes[]; };
layout(set = 0, binding = 2, scalar) readonly buffer PlaneExtras { uint planeExtras[]; };
layout(set = 0, binding = 3, scalar) readonly buffer FirstFaces { uint firstFaces[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 5, scalar) readonly buffer TriangleFirst { uint triangleFirst[]; };
layout(set = 0, binding = 6, scalar) readonly buffer TriangleIds { uint triangleIds[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 9, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(push_constant, scalar) uniform Push { KeptHits kept; };
layout(constant_id = 0) const bool kTriangles = false;
#include "shared/dispatch.glsl"

uvec2 contents = uvec2(0x2545f491u, 0x9e3779b9u);
void add(uint word) {
  contents.x = hashBits(contents.x ^ word);
  contents.y = (contents.y ^ word) * 0x01000193u;
  contents.y ^= contents.y >> 15;
}

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= kept.voxelCount) return;
  KeptWords to = KeptWords(kept.address);
  to.words[voxel] = voxels[voxel];
  uvec2 plane = planes[voxel];
  add(plane.x);
  add(plane.y);
  for (uint i = 0u; (plane.y & kPlaneMore) != 0u && i < kFaceCount; ++i) {
    plane = planes[kept.voxelCount + planeExtras[voxel] + i];
    add(plane.x);
    add(plane.y);
  }
  for (uint s = firstFaces[voxel]; s < firstFaces[voxel + 1u]; ++s) {
    Face face = faces[s];
    to.words[keptFace(kept, s)] = face.key;
    add(face.key & 7u);
    add(face.normal);
    add(face.position);
  }
  if (kTriangles) {
    for (uint e = triangleFirst[voxel]; e < triangleFirst[voxel + 1u]; ++e) {
      uint id = listedTriangle(triangleIds[e]);
      add(listedApart(triangleIds[e]));
      add(triangleMaterials[id]);
      for (uint c = 0u; c < 3u; ++c) {
        Vertex vertex = vertices[indices[3u * id + c]];
        for (uint k = 0u; k < 3u; ++k) add(floatBitsToUint(vertex.position[k]));
        for (uint k = 0u; k < 2u; ++k) add(floatBitsToUint(vertex.uvBase[k]));
      }
    }
  }
  to.words[keptContents(kept, voxel)] = contents.x;
  to.words[keptContents(kept, voxel) + 1u] = contents.y;
}
