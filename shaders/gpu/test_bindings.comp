#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// For tests/gpu: one binding of every kind. Those whose bit in `present` is 0 may be null and are not touched.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) buffer Out { uint result[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Words { uint words[]; };
layout(set = 0, binding = 2) uniform Constants { uvec4 constants; };
layout(set = 0, binding = 3, rgba32f) uniform image2D color;
layout(set = 0, binding = 4, r32ui) uniform uimage2DArray layered;
layout(set = 0, binding = 5) uniform sampler2D sampledColor;
layout(set = 0, binding = 6) uniform usampler2DArray sampledLayers;
layout(set = 0, binding = 7) uniform sampler2D depth;
layout(set = 0, binding = 8, r32i) uniform iimage2D signedImage;
layout(set = 0, binding = 9) uniform isampler2D sampledSigned;
layout(set = 0, binding = 10) uniform usamplerBuffer texelWords;
layout(set = 0, binding = 11) uniform samplerBuffer texelVectors;
layout(push_constant, scalar) uniform Push {
  uint present;
  uint width;
  uint height;
};

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (p.x >= int(width) || p.y >= int(height)) return;
  uint sum = 0u;
  if ((present & 2u) != 0u) sum += words[p.x];
  if ((present & 4u) != 0u) sum += constants.y;
  if ((present & 8u) != 0u) sum += uint(imageLoad(color, p).z);
  if ((present & 16u) != 0u) {
    sum += imageLoad(layered, ivec3(p, 1)).x;
    imageStore(layered, ivec3(p, 0), uvec4(sum));
  }
  // The sampler is nearest and clamps: past the edge lies the edge.
  const vec2 size = vec2(width, height);
  if ((present & 32u) != 0u) sum += uint(textureLod(sampledColor, (vec2(p) + 0.9) / size, 0.0).z);
  if ((present & 64u) != 0u) sum += textureLod(sampledLayers, vec3((vec2(p) + 0.1) / size, 1.0), 0.0).x;
  if ((present & 128u) != 0u) sum += uint(textureLod(depth, vec2(p) / size + 5.0, 0.0).x * 1024.0);
  if ((present & 256u) != 0u) sum += uint(imageLoad(signedImage, p).x);
  if ((present & 512u) != 0u) sum += uint(textureLod(sampledSigned, (vec2(p) + 0.5) / size, 0.0).x);
  if ((present & 1024u) != 0u) sum += texelFetch(texelWords, 64 + p.x).x;
  if ((present & 2048u) != 0u) sum += uint(texelFetch(texelVectors, p.y).w);
  result[uint(p.y) * width + uint(p.x)] = sum;
}
