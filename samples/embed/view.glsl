// What the host's shaders read, by address: its vertices as triangles, and its view. gbuffer.h has the same structs.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Vertex {
  vec3 position, normal, albedo, emission;
};
layout(buffer_reference, scalar) readonly buffer Vertices { Vertex at[]; };
layout(buffer_reference, scalar) readonly buffer View {
  mat4 viewProjection, inverseViewProjection;
  vec3 eye, forward;
  uvec2 size;
};
layout(push_constant, scalar) uniform Push {
  Vertices vertices;
  View view;
};
