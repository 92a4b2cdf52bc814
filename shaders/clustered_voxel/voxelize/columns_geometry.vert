#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Geometry way: the geometry shader reads the triangle itself; all it needs is the id.
layout(location = 0) flat out uint vertexTriangleId;

void main() {
  vertexTriangleId = uint(gl_VertexIndex) / 3u;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
