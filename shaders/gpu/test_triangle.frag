#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests/gpu: counts fragments in a buffer and writes the primitive's number.
layout(constant_id = 0) const uint kScale = 1u;
layout(set = 0, binding = 1, scalar) buffer Hits { uint hits[]; };
layout(push_constant, scalar) uniform Push { uint width; };
layout(location = 0) out vec4 color;
void main() {
  atomicAdd(hits[uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x)], kScale);
  color = vec4(gl_FragCoord.xy, float(gl_PrimitiveID), 1.0);
}
