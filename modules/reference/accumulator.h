// Means and variances of what passes bring, for one pixel. Internal to modules/reference.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace radivox::reference {

constexpr size_t kAovCount = 6;  ///< color, direct, indirect, irradiance_direct, irradiance_indirect, albedo
constexpr size_t kChannelCount = 3 * kAovCount;
using Channels = std::array<float, kChannelCount>;

/// Running mean and sum of squared differences from it (Welford): nothing cancels, however small the variance.
struct Moments {
  Channels mean{};
  Channels squares{};

  /// `count`: of values, this one included.
  void add(const Channels& value, uint32_t count) {
    const float share = 1.f / static_cast<float>(count);
    for (size_t c = 0; c < kChannelCount; ++c) {
      const float before = value[c] - mean[c];
      mean[c] += before * share;
      squares[c] += before * (value[c] - mean[c]);
    }
  }
};

/// Even and odd passes apart.
struct PixelMoments {
  std::array<Moments, 2> half;
};

}  // namespace radivox::reference
