#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "frame/tone_map.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kLow = false;  // second pass: the low half of those in the selected bin

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D colorImage;
layout(set = 0, binding = 1, scalar) buffer Bins { uint bins[]; };
layout(set = 0, binding = 2, scalar) buffer Selected { Selection selection; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(colorImage)))) return;
  uint bits;
  if (!luminanceBits(imageLoad(colorImage, pixel).rgb, bits)) return;
  uint high = bits >> 16;
  if (!kLow) {
    atomicAdd(bins[high], 1u);
  } else if (high == selection.highBin) {
    atomicAdd(bins[kHighBins + (bits & 0xffffu)], 1u);
  } else if (high > selection.highBin) {
    atomicMin(selection.next, bits);
  }
}
