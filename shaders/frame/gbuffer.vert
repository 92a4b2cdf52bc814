#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/scene.h"

// Only the triangle's id goes on: the fragment shader finds everything else from the camera ray, so that no interpolator's
// rounding moves a surface point off its triangle's plane.
layout(set = 0, binding = 0, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 5, scalar) readonly buffer View { Camera camera; };

layout(location = 0) flat out uint triangle;

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  gl_Position = camera.viewProjection * vec4(vertices[indices[gl_VertexIndex]].position, 1.0);
}
