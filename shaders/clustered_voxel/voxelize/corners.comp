#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Corners of triangles as rays fetch them: shared/triangle_corners.h.
layout(local_size_x = 64) in;
#define RADIVOX_BIND_GRID 0
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#include "shared/triangle_corners.h"
#include "shared/voxel_lookup.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Corners { uvec2 corners[]; };
layout(push_constant, scalar) uniform Push { uint triangleCount; };

void main() {
  uint id = radivoxItemIndex();
  if (id >= triangleCount) return;
  float steps = cornerSteps(grid.size);
  for (uint k = 0u; k < 3u; ++k) corners[3u * id + k] = encodeCorner(toGridSpace(grid, vertices[indices[3u * id + k]].position), steps);
}
