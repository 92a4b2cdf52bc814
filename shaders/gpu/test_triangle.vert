#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests/gpu: triangles pulled from a buffer, positions in clip space.
layout(set = 0, binding = 0, scalar) readonly buffer Positions { vec3 positions[]; };
void main() { gl_Position = vec4(positions[gl_VertexIndex], 1.0); }
