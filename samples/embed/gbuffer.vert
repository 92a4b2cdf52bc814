#version 460
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"
layout(location = 0) flat out uint triangle;

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  gl_Position = view.viewProjection * vec4(vertices.at[gl_VertexIndex].position, 1.0);
}
