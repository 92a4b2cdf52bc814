// Two noisy pictures of the same thing, and whether they differ by more than their noise: an estimate with variances against a truth in two
// independent files (../shared/truth), stored as half floats.
#pragma once

#include "engine/image/image.h"

namespace radivox::oracles {

struct NoisyTruth {
  image::Image a, b;
  double samplesA = 0, samplesB = 0;
  image::Image albedo;  ///< pixels of albedo 0 are left out
};
/// Layer `aov` of both files; `name` as in "sponza_b8".
NoisyTruth loadNoisyTruth(const std::string& name, const std::string& aov, double samplesA, double samplesB);

struct ZTest {
  size_t count = 0;       ///< values compared: pixels or blocks, each channel
  double within5 = 0;     ///< share with |z| < 1.960: 5 % significance, 0.95 if both are normal and unbiased
  double within1 = 0;     ///< |z| < 2.576: 1 %, 0.99 expected
  double meanSquare = 0;  ///< of z; 1 expected
  double ratio = 1;       ///< mean(test) / mean(truth)
  double ratioError = 0;  ///< its standard error
  double worstRegion =
      0;  ///< largest |ratio − 1| of 8 × 6 regions beyond three standard errors, among those with a tenth of the mean light
};

/// Pixel by pixel (block = 1) or over means of block × block pixels. Variances: the test's own; the truth's from (a − b)², for pixels pooled
/// over 7 × 7 of them (as is the test's, whose few passes tell little of a single pixel); both with the rounding to half floats.
ZTest compareWithNoise(const NoisyTruth& truth, const image::Image& test, const image::Image& testVariance, uint32_t block);

}  // namespace radivox::oracles
