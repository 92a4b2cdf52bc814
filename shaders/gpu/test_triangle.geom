#version 460
// For tests/gpu: each triangle twice, the copy mirrored in x; the fragment shader sees the doubled primitive number.
layout(triangles) in;
layout(triangle_strip, max_vertices = 6) out;
void main() {
  for (int copy = 0; copy < 2; ++copy) {
    for (int k = 0; k < 3; ++k) {
      gl_Position = gl_in[k].gl_Position * vec4(copy == 0 ? 1.0 : -1.0, 1.0, 1.0, 1.0);
      gl_PrimitiveID = gl_PrimitiveIDIn * 2 + copy;
      EmitVertex();
    }
    EndPrimitive();
  }
}
