#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Corners and normals of triangles as rays fetch them: shared/triangle_corners.h.
layout(local_size_x = 64) in;
#define RADIVOX_BIND_GRID 0
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/triangle_corners.h"
#include "shared/voxel_lookup.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Corners { vec4 corners[]; };
layout(push_constant, scalar) uniform Push { uint triangleCount; };
#include "shared/triangle_normal.glsl"

void main() {
  uint id = radivoxItemIndex();
  if (id >= triangleCount) return;
  vec3 a = vertices[indices[3u * id]].position;
  vec3 b = vertices[indices[3u * id + 1u]].position;
  vec3 c = vertices[indices[3u * id + 2u]].position;
  vec3 n = triangleNormal(id);
  corners[3u * id] = vec4(toGridSpace(grid, a), n.x);
  corners[3u * id + 1u] = vec4(toGridSpace(grid, b), n.y);
  corners[3u * id + 2u] = vec4(toGridSpace(grid, c), n.z);
}
