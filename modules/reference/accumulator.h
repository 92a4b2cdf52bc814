// Means and variances of what passes bring, for one pixel. Internal to modules/reference.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace radivox::reference {

constexpr size_t kAovCount = 6;  ///< color, direct, indirect, irradiance_direct, irradiance_indirect, albedo
constexpr size_t kChannelCount = 3 * kAovCount;
constexpr size_t kDirect = 3, kIrradiance = 9, kAlbedo = 15;  ///< first channels: of direct and indirect, of E of both, of albedo
using Channels = std::array<float, kChannelCount>;

/// Running mean and sum of squared differences from it (Welford): nothing cancels, however small the variance.
struct Moments {
  Channels mean{};
  Channels squares{};
  std::array<float, 6>
      products{};  ///< of what differs from the means of direct and indirect with what does from albedo's: irradiance is their quotient

  /// `count`: of values, this one included.
  void add(const Channels& value, uint32_t count) {
    const float share = 1.f / static_cast<float>(count);
    std::array<float, 6> reflected;
    for (size_t c = 0; c < 6; ++c) reflected[c] = value[kDirect + c] - mean[kDirect + c];
    for (size_t c = 0; c < kChannelCount; ++c) {
      const float before = value[c] - mean[c];
      mean[c] += before * share;
      squares[c] += before * (value[c] - mean[c]);
    }
    for (size_t c = 0; c < 6; ++c) products[c] += reflected[c] * (value[kAlbedo + c % 3] - mean[kAlbedo + c % 3]);
  }
};

/// Even and odd passes apart.
struct PixelMoments {
  std::array<Moments, 2> half;
};

}  // namespace radivox::reference
