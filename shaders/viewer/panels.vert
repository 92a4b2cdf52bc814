#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Triangles of the panels and pictures of a window (samples/viewer/window/painter.h).
#include "viewer/panels.h"

layout(set = 0, binding = 0, scalar) readonly buffer Vertices { PanelVertex vertices[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(push_constant, scalar) uniform Push { PanelPush push; };
layout(location = 0) out vec2 uv;
layout(location = 1) out vec4 colour;

void main() {
  PanelVertex v = vertices[indices[push.firstIndex + gl_VertexIndex] + push.firstVertex];
  uv = v.uv;
  colour = unpackUnorm4x8(v.colour);
  gl_Position = vec4(v.position / vec2(push.width, push.height) * 2.0 - 1.0, 0.0, 1.0);
}
