#include "tests/oracles/z_test.h"

#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/truth.h"

namespace radivox::oracles {

namespace {

/// Variance of rounding a value to 11 significant bits.
double halfRounding(double value) {
  const double unit = std::exp2(std::floor(std::log2(std::max(std::abs(value), 6e-5))) - 10);
  return unit * unit / 12;
}

bool isCounted(const NoisyTruth& truth, uint32_t x, uint32_t y) {
  return truth.albedo.at(x, y, 0) + truth.albedo.at(x, y, 1) + truth.albedo.at(x, y, 2) > 0.f;
}

/// Mean over the 7 × 7 pixels about each that count.
image::Image pooled(const image::Image& in, const NoisyTruth& truth) {
  image::Image out = in;
  const auto width = static_cast<int>(in.width), height = static_cast<int>(in.height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum[3] = {}, count = 0;
      for (int v = std::max(y - 3, 0); v <= std::min(y + 3, height - 1); ++v) {
        for (int u = std::max(x - 3, 0); u <= std::min(x + 3, width - 1); ++u) {
          if (!isCounted(truth, static_cast<uint32_t>(u), static_cast<uint32_t>(v))) continue;
          for (uint32_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(in.at(static_cast<uint32_t>(u), static_cast<uint32_t>(v), c));
          ++count;
        }
      }
      for (uint32_t c = 0; c < 3 && count > 0; ++c)
        out.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y), c) = static_cast<float>(sum[c] / count);
    }
  }
  return out;
}

struct Region {
  double test = 0, truth = 0, variance = 0;
};

}  // namespace

NoisyTruth loadNoisyTruth(const std::string& name, const std::string& aov, double samplesA, double samplesB) {
  const std::string file = sharedFolder() + "/truth/" + name;
  const auto a = image::readExr(file + "_a.exr"), b = image::readExr(file + "_b.exr");
  return {layerOf(a, aov), layerOf(b, aov), samplesA, samplesB, layerOf(b, "albedo")};
}

ZTest compareWithNoise(const NoisyTruth& truth, const image::Image& test, const image::Image& testVariance, uint32_t block) {
  const double samples = truth.samplesA + truth.samplesB, shareA = truth.samplesA / samples, shareB = truth.samplesB / samples;
  image::Image mean = truth.a, variance = truth.a;
  for (size_t i = 0; i < mean.data.size(); ++i) {
    const auto a = static_cast<double>(truth.a.data[i]), b = static_cast<double>(truth.b.data[i]);
    const double t = shareA * a + shareB * b;
    mean.data[i] = static_cast<float>(t);
    // E (a − b)² = σ² (1/nA + 1/nB) for the variance σ² of a sample; of the mean over all it is σ²/(nA + nB).
    const double noise = (a - b) * (a - b) * shareA * shareB;
    variance.data[i] = static_cast<float>(noise + halfRounding(t) * (shareA * shareA + shareB * shareB));
  }
  image::Image own = testVariance;
  if (block == 1) {
    variance = pooled(variance, truth);
    own = pooled(own, truth);
  }

  ZTest result;
  double within5 = 0, within1 = 0, squares = 0;
  Region all, regions[48];
  for (uint32_t top = 0; top + block <= mean.height; top += block) {
    for (uint32_t left = 0; left + block <= mean.width; left += block) {
      for (uint32_t c = 0; c < 3; ++c) {
        Region here;
        uint32_t counted = 0;
        for (uint32_t y = top; y < top + block; ++y) {
          for (uint32_t x = left; x < left + block; ++x) {
            if (!isCounted(truth, x, y)) continue;
            ++counted;
            here.test += static_cast<double>(test.at(x, y, c));
            here.truth += static_cast<double>(mean.at(x, y, c));
            here.variance += static_cast<double>(variance.at(x, y, c)) + static_cast<double>(own.at(x, y, c));
          }
        }
        if (counted == 0) continue;
        Region& region = regions[8 * std::min(top * 6 / mean.height, 5u) + std::min(left * 8 / mean.width, 7u)];
        for (Region* sum : {&all, &region}) {
          sum->test += here.test;
          sum->truth += here.truth;
          sum->variance += here.variance;
        }
        if (2 * counted < block * block) continue;
        const double z = (here.test - here.truth) / std::sqrt(here.variance + 1e-12);
        ++result.count;
        within5 += std::abs(z) < 1.960 ? 1 : 0;
        within1 += std::abs(z) < 2.576 ? 1 : 0;
        squares += z * z;
      }
    }
  }
  const auto count = static_cast<double>(result.count);
  result.within5 = within5 / count;
  result.within1 = within1 / count;
  result.meanSquare = squares / count;
  result.ratio = all.test / all.truth;
  result.ratioError = std::sqrt(all.variance) / all.truth;
  for (const Region& region : regions) {
    if (region.truth < 0.1 * all.truth / 48) continue;
    const double apart = std::abs(region.test / region.truth - 1) - 3 * std::sqrt(region.variance) / region.truth;
    result.worstRegion = std::max(result.worstRegion, apart);
  }
  return result;
}

}  // namespace radivox::oracles
