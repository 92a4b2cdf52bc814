// Random numbers: strata, uniformity, independence.
#include "modules/reference/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace radivox::reference_test {
namespace {

using reference::Sampler;

TEST(ReferenceSampler, EveryStratumHoldsItsShare) {
  // Of 2^k samples of a pair, each box of a 2^a × 2^(k−a) grid holds one, for every a; of the first 2^j samples likewise.
  for (uint64_t key = 0; key < 20; ++key) {
    for (const uint32_t k : {0u, 1u, 4u, 6u}) {
      for (uint32_t dimension = 0; dimension < 4; ++dimension) {
        for (uint32_t a = 0; a <= k; ++a) {
          std::set<std::pair<int, int>> boxes;
          std::set<int> intervals;
          for (uint32_t i = 0; i < 1u << k; ++i) {
            Sampler sampler(key * 77 + 5, i);
            for (uint32_t d = 0; d < dimension; ++d) sampler.next2D();
            const auto [u, v] = sampler.next2D();
            ASSERT_TRUE(u >= 0 && u < 1 && v >= 0 && v < 1);
            boxes.insert({static_cast<int>(u * (1u << a)), static_cast<int>(v * (1u << (k - a)))});
            intervals.insert(static_cast<int>(sampler.next1D() * (1u << k)));
          }
          EXPECT_EQ(boxes.size(), 1u << k) << k << " " << a;
          EXPECT_EQ(intervals.size(), 1u << k);
        }
      }
    }
  }
}

TEST(ReferenceSampler, UniformAndIndependentOverKeys) {
  // Sample 3 of many keys: 16 × 16 boxes filled evenly, and so for pairs of values from different dimensions and samples.
  constexpr int kKeys = 1 << 16, kSide = 16;
  std::vector<std::vector<int>> counts(4, std::vector<int>(kSide * kSide));
  const auto cell = [](double u, double v) { return static_cast<size_t>(u * kSide) * kSide + static_cast<size_t>(v * kSide); };
  for (uint64_t key = 0; key < kKeys; ++key) {
    Sampler one(key, 3), other(key + 1, 3);
    const auto [u, v] = one.next2D();
    const auto [s, t] = one.next2D();
    const auto [x, y] = other.next2D();
    ++counts[0][cell(u, v)];
    ++counts[1][cell(u, s)];
    ++counts[2][cell(v, t)];
    ++counts[3][cell(u, x)];
  }
  for (const std::vector<int>& boxes : counts) {
    double chi = 0;
    const double expected = static_cast<double>(kKeys) / (kSide * kSide);
    for (const int n : boxes) chi += (n - expected) * (n - expected) / expected;
    EXPECT_NEAR(chi, 255, 4.5 * std::sqrt(2 * 255.0));
  }
}

TEST(ReferenceSampler, StratifyingHelpsAndDoesNotShift) {
  // ∫ of a smooth function by 16 samples: unbiased over keys, and with a hundredth of the variance of independent ones.
  double sum = 0, squares = 0;
  constexpr int kKeys = 20000;
  for (uint64_t key = 0; key < kKeys; ++key) {
    double estimate = 0;
    for (uint32_t i = 0; i < 16; ++i) {
      const auto [u, v] = Sampler(key, i).next2D();
      estimate += std::exp(u + 2 * v) / 16;
    }
    sum += estimate;
    squares += estimate * estimate;
  }
  const double exact = (std::exp(1) - 1) * (std::exp(2) - 1) / 2;
  const double mean = sum / kKeys, variance = squares / kKeys - mean * mean;
  const double independent = ((std::exp(2) - 1) / 2 * (std::exp(4) - 1) / 4 - exact * exact) / 16;
  EXPECT_NEAR(mean, exact, 3.5 * std::sqrt(variance / kKeys));
  EXPECT_LT(variance, 0.03 * independent);
}

}  // namespace
}  // namespace radivox::reference_test
