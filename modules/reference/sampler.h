// Random numbers by counting: a value depends on (key, sample, dimension) alone, so any thread may make any sample at any time.
//
// Samples 0 … 2^k − 1 of one key are stratified together: each pair of dimensions is the (0, 2)-sequence of Sobol, its order and its digits
// shuffled by Owen's nested scramble with a seed of that key and pair (Owen 1995; by hashing, Burley 2020). Each value is uniform over the
// seeds, and so estimates are unbiased; two keys are independent.
#pragma once

#include <array>
#include <cstdint>

namespace radivox::reference {

/// A bijection of 64 bits in which every bit of the input reaches every bit of the output.
inline uint64_t mixBits(uint64_t x) {
  x ^= x >> 32;
  x *= 0xe9846af9b1a615dull;
  x ^= x >> 32;
  x *= 0xe9846af9b1a615dull;
  x ^= x >> 28;
  return x;
}
inline uint64_t combineKeys(uint64_t a, uint64_t b) { return mixBits(a * 0x9e3779b97f4a7c15ull + mixBits(b + 0x632be59bd9b4e019ull)); }

inline uint32_t reverseBits(uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// A permutation in which each bit is flipped by a function of the bits below it and the seed: on digits from the least significant up,
/// that is Owen's scramble. The first step makes it uniform over the seed's low half.
inline uint32_t scrambleFromLow(uint32_t x, uint64_t seed) {
  x += static_cast<uint32_t>(seed);
  x ^= x * 0x6c50b47cu;
  x *= static_cast<uint32_t>(seed >> 32) | 1u;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

class Sampler {
 public:
  Sampler(uint64_t key, uint32_t sample) : key_(key), reversedSample_(reverseBits(sample)) {}

  /// The next pair of dimensions, each in [0, 1).
  std::array<double, 2> next2D() {
    const uint64_t seed = combineKeys(key_, dimension_++);
    const uint32_t order = reverseBits(scrambleFromLow(reversedSample_, seed));
    // Digits of the two coordinates, most significant in the lowest bit: the index itself, and Pascal's triangle modulo 2 times it.
    uint32_t pascal = order;
    pascal ^= (pascal >> 1) & 0x55555555u;
    pascal ^= (pascal >> 2) & 0x33333333u;
    pascal ^= (pascal >> 4) & 0x0f0f0f0fu;
    pascal ^= (pascal >> 8) & 0x00ff00ffu;
    pascal ^= (pascal >> 16) & 0x0000ffffu;
    const uint64_t second = mixBits(seed + 0xd1b54a32d192ed03ull);
    const uint64_t third = mixBits(second + 0xd1b54a32d192ed03ull);
    return {toUnit(reverseBits(scrambleFromLow(order, second))), toUnit(reverseBits(scrambleFromLow(pascal, third)))};
  }
  double next1D() {
    const uint64_t seed = combineKeys(key_, dimension_++);
    const uint32_t order = reverseBits(scrambleFromLow(reversedSample_, seed));
    return toUnit(reverseBits(scrambleFromLow(order, mixBits(seed + 0xd1b54a32d192ed03ull))));
  }

 private:
  static double toUnit(uint32_t bits) { return static_cast<double>(bits) * 0x1p-32; }

  uint64_t key_;
  uint32_t reversedSample_;
  uint64_t dimension_ = 0;
};

}  // namespace radivox::reference
