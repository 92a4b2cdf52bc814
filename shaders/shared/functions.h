// Functions with the same text in C++ and GLSL, and so the same bits: only +, −, ×, floor and integer operations, which Vulkan
// rounds as IEEE does, in variables marked RADIVOX_PRECISE so that no compiler fuses or reorders them. Division and square root
// are not exact on every device; preciseReciprocal and preciseInverseSqrt stand in for them.
#ifndef RADIVOX_SHADERS_SHARED_FUNCTIONS_H
#define RADIVOX_SHADERS_SHARED_FUNCTIONS_H
#include "types.h"

#ifdef __cplusplus
#include <bit>
namespace radivox::shared {
using glm::abs;
using glm::clamp;
using glm::floor;
using glm::max;
using glm::min;
inline float uintBitsToFloat(uint bits) { return std::bit_cast<float>(bits); }
inline uint floatBitsToUint(float value) { return std::bit_cast<uint>(value); }
inline int bitCount(uint bits) { return std::popcount(bits); }
}  // namespace radivox::shared
#define RADIVOX_FUNCTION inline
#define RADIVOX_PRECISE
#else
#define RADIVOX_FUNCTION
#define RADIVOX_PRECISE precise
#endif

RADIVOX_SHARED_BEGIN

// 1 / x within 2 units in the last place, for x in [2⁻¹²⁰, 2¹²⁰].
RADIVOX_FUNCTION float preciseReciprocal(float x) {
  RADIVOX_PRECISE float r = uintBitsToFloat(0x7ef311c7u - floatBitsToUint(x));
  for (int i = 0; i < 4; ++i) {
    RADIVOX_PRECISE float miss = 1.0f - x * r;
    r = r + r * miss;
  }
  return r;
}

// 1 / √x within 2 units in the last place, for x in [2⁻¹²⁰, 2¹²⁰].
RADIVOX_FUNCTION float preciseInverseSqrt(float x) {
  RADIVOX_PRECISE float r = uintBitsToFloat(0x5f3759dfu - (floatBitsToUint(x) >> 1));
  for (int i = 0; i < 4; ++i) {
    RADIVOX_PRECISE float square = r * r;
    RADIVOX_PRECISE float miss = 1.0f - x * square;
    r = r + 0.5f * r * miss;
  }
  return r;
}

RADIVOX_SHARED_END
#endif
