// What the passes of the tone map share. Luminance of a pixel is sorted by its float bits: for numbers ≥ 0 their order is the
// numbers' order, and the high half is a histogram over log₂ with 128 steps an octave. Two passes of 16 bits find an order statistic exactly.
#ifndef RADIVOX_SHADERS_FRAME_TONE_MAP_GLSL
#define RADIVOX_SHADERS_FRAME_TONE_MAP_GLSL

const uint kHighBins = 32768u;
const uint kLowBins = 65536u;

struct Selection {
  uint highBin;      // high half of the percentile's bits
  uint rank;         // its rank among the pixels of that bin
  uint fraction;     // of the way to the next value, in hundredths
  uint next;         // least bits in any higher bin; ~0: none
  uint finiteCount;  // pixels that are numbers
};

// False where a channel is infinite or not a number.
bool luminanceBits(vec3 color, out uint bits) {
  float luminance = dot(max(color, vec3(0.0)), vec3(0.2126, 0.7152, 0.0722));
  bits = floatBitsToUint(max(luminance, 0.0)) & 0x7fffffffu;
  return !any(isnan(color)) && !any(isinf(color)) && bits < 0x7f800000u;
}

#endif
