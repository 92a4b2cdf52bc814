#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "frame/tone_map.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kOperator = 0u;  // linear, filmic

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D colorImage;
layout(set = 0, binding = 1, scalar) readonly buffer Exposure { float exposure; };
layout(set = 0, binding = 2, rgba8) writeonly uniform image2D displayImage;
layout(set = 0, binding = 3, scalar) buffer Status { uint notFinite; uint exposureBits; };

// A toe and a shoulder: 0 → 0, 0.18 → 0.24, 1 → 0.76, ∞ → 1.
vec3 filmic(vec3 x) {
  x = min(x, vec3(1e4));
  return x * (4.0 * x + 0.2) / (x * (4.0 * x + 1.2) + 0.35);
}

vec3 encodeSrgb(vec3 x) {
  return mix(1.055 * pow(max(x, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(colorImage)))) return;
  if (pixel == ivec2(0)) exposureBits = floatBitsToUint(exposure);
  vec3 color = imageLoad(colorImage, pixel).rgb;
  uint bits;
  if (!luminanceBits(color, bits)) {
    // Black, and counted: what is not a number is a bug to report, not a colour.
    atomicAdd(notFinite, 1u);
    imageStore(displayImage, pixel, vec4(0.0, 0.0, 0.0, 1.0));
    return;
  }
  color = max(color, vec3(0.0)) * exposure;
  if (kOperator == 1u) color = filmic(color);
  imageStore(displayImage, pixel, vec4(encodeSrgb(clamp(color, vec3(0.0), vec3(1.0))), 1.0));
}
