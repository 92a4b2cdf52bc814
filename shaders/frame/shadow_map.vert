#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/scene.h"

// One shadow view: three vertices a triangle, pulled from the scene's buffers. The viewport is the view's tile.
layout(set = 0, binding = 0, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 5, scalar) readonly buffer ShadowViews { ShadowView shadowViews[]; };

layout(push_constant, scalar) uniform Push { uint view; };

layout(location = 0) flat out uint triangle;
layout(location = 1) out vec2 uv;

void main() {
  Vertex vertex = vertices[indices[gl_VertexIndex]];
  triangle = uint(gl_VertexIndex) / 3u;
  uv = vertex.uvBase;
  gl_Position = shadowViews[view].viewProjection * vec4(vertex.position, 1.0);
}
