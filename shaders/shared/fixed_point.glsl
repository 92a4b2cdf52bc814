// Sums that come out the same for any order of atomics, on every device: 64-bit two's complement fixed point in two 32-bit words
// (x low, y high), no 64-bit types. All of it is integer arithmetic on the bits of floats, so no float mode of a device shows.
//
//   range: |Σ| < 2^31 with 32 fractional bits, resolution 2^-32; toFixed saturates (infinities and NaN too: a broken input must show)
//   radivoxFixedAtomicAdd(lowWord, highWord, value): both words in one storage buffer or shared memory. Only once all adds are done
//   (barrier) do the two words belong together.
#ifndef RADIVOX_SHADERS_SHARED_FIXED_POINT_GLSL
#define RADIVOX_SHADERS_SHARED_FIXED_POINT_GLSL

const int kFixedFractionalBits = 32;

uvec2 fixedAdd(uvec2 a, uvec2 b) {
  const uint low = a.x + b.x;
  return uvec2(low, a.y + b.y + uint(low < a.x));
}

uvec2 fixedNegate(uvec2 a) { return fixedAdd(~a, uvec2(1u, 0u)); }

bool fixedIsNegative(uvec2 a) { return (a.y & 0x80000000u) != 0u; }

/// v · 2^fractionalBits, rounded to the nearest integer, halves away from 0. For values that are always small (or large) another
/// number of fractional bits than 32 keeps more of them; 0 ≤ fractionalBits ≤ 90.
uvec2 toFixedBits(float v, int fractionalBits) {
  const uint bits = floatBitsToUint(v);
  const int exponent = int((bits >> 23) & 0xffu);
  const uint mantissa = exponent == 0 ? 0u : (bits & 0x7fffffu) | 0x800000u;  // denormal floats count as 0
  const int shift = exponent - 150 + fractionalBits;
  uvec2 magnitude;
  if (shift < -24) {
    magnitude = uvec2(0u);
  } else if (shift < 0) {
    magnitude = uvec2((mantissa + (1u << (-shift - 1))) >> -shift, 0u);
  } else if (shift > 39 || exponent == 255) {
    magnitude = uvec2(0xffffffffu, 0x7fffffffu);
  } else if (shift >= 32) {
    magnitude = uvec2(0u, mantissa << (shift - 32));
  } else {
    magnitude = uvec2(mantissa << shift, shift == 0 ? 0u : mantissa >> (32 - shift));
  }
  return (bits & 0x80000000u) != 0u ? fixedNegate(magnitude) : magnitude;
}

uvec2 toFixed(float v) { return toFixedBits(v, kFixedFractionalBits); }

/// The nearest float, ties to even.
float fixedToFloatBits(uvec2 a, int fractionalBits) {
  const bool negative = fixedIsNegative(a);
  const uvec2 m = negative ? fixedNegate(a) : a;
  if (m.x == 0u && m.y == 0u) return 0.0;
  const int top = m.y != 0u ? 32 + findMSB(m.y) : findMSB(m.x);  // most significant bit, 0…63
  const int drop = top - 23;                                     // bits below the mantissa
  uint mantissa;
  if (drop <= 0) {
    mantissa = m.x << -drop;
  } else {
    // kept = m >> drop; half and rest decide the rounding.
    mantissa = drop >= 32 ? m.y >> (drop - 32) : (m.y << (32 - drop)) | (m.x >> drop);
    const int below = drop - 1;
    const uint half_ = below >= 32 ? (m.y >> (below - 32)) & 1u : (m.x >> below) & 1u;
    const uint restLow = below >= 32 ? m.x : m.x & ((1u << below) - 1u);
    const uint restHigh = below > 32 ? m.y & ((1u << (below - 32)) - 1u) : 0u;
    const bool rest = restLow != 0u || restHigh != 0u;
    if (half_ != 0u && (rest || (mantissa & 1u) != 0u)) ++mantissa;
  }
  // A mantissa that rounded up to 2^24 carries into the exponent, as it must.
  const uint exponent = uint(top - fractionalBits + 127 - 1);
  return uintBitsToFloat((negative ? 0x80000000u : 0u) | ((exponent << 23) + mantissa));
}

float fixedToFloat(uvec2 a) { return fixedToFloatBits(a, kFixedFractionalBits); }

/// A macro, since GLSL passes no references to memory. The low word's add tells whether it wrapped; the carry goes to the high word.
/// Sums of carries commute, so any order ends in the same two words.
#define radivoxFixedAtomicAdd(lowWord, highWord, value)                             \
  {                                                                                 \
    const uvec2 fixedValue_ = (value);                                              \
    const uint fixedOld_ = fixedValue_.x != 0u ? atomicAdd(lowWord, fixedValue_.x) : 0u; \
    const uint fixedHigh_ = fixedValue_.y + uint(fixedOld_ + fixedValue_.x < fixedOld_); \
    if (fixedHigh_ != 0u) atomicAdd(highWord, fixedHigh_);                          \
  }

#endif
