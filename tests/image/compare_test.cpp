// Error figures against images whose error is known, and against noise whose distribution is.
#include "engine/image/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/error.h"

namespace image = radivox::image;

namespace {

template <class F>
std::string errorOf(F call) {
  try {
    call();
  } catch (const radivox::Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(radivox::ErrorCode::BadInput));
    return e.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

image::Image ramp(uint32_t width, uint32_t height) {
  image::Image result{width, height, 3, {}};
  for (uint32_t i = 0; i < width * height * 3; ++i) result.data.push_back(0.1f + static_cast<float>((i * 7) % 31));
  return result;
}

image::Image plus(image::Image in, float offset) {
  for (float& value : in.data) value += offset;
  return in;
}

/// `in` with Gaussian noise that all channels of a pixel share in part.
image::Image noisy(const image::Image& in, float deviation, std::mt19937& random) {
  std::normal_distribution<float> gauss(0.f, deviation);
  image::Image out = in;
  for (size_t i = 0; i < in.data.size(); i += 3) {
    const float shared = gauss(random);
    for (size_t c = 0; c < 3; ++c) out.data[i + c] += shared + 0.5f * gauss(random);
  }
  return out;
}

TEST(Compare, KnownDifferences) {
  // r = 1, 3 and t = 2, 3: bias 5/4, MSE 1/2, relMSE ((1)²/(1 + 0.04) + 0)/2 with 0.01·mean² = 0.04.
  const image::Truth truth = image::truthOf(image::Image{2, 1, 1, {1.f, 3.f}});
  const image::Comparison c = image::compare(truth, image::Image{2, 1, 1, {2.f, 3.f}});
  EXPECT_EQ(c.pixelCount, 2u);
  EXPECT_DOUBLE_EQ(c.bias, 1.25);
  EXPECT_DOUBLE_EQ(c.mse, 0.5);
  EXPECT_DOUBLE_EQ(c.rmse, std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(c.plainRmse, c.rmse);
  EXPECT_DOUBLE_EQ(c.relMse, 0.5 / 1.04);
  EXPECT_TRUE(std::isnan(c.psnrBlocks)) << "no 4×4 blocks in 2×1 pixels";
  EXPECT_FALSE(c.uncertainty);
}

TEST(Compare, EqualImagesHaveNoError) {
  const image::Image a = ramp(9, 8);
  const image::Comparison c = image::compare(image::truthOf(a), a);
  EXPECT_EQ(c.bias, 1.0);
  EXPECT_EQ(c.mse, 0.0);
  EXPECT_EQ(c.relMse, 0.0);
  EXPECT_TRUE(std::isinf(c.psnr));
  EXPECT_TRUE(std::isinf(c.psnrBlocks));
  const image::Image black{4, 4, 3, std::vector<float>(48)};
  const image::Comparison dark = image::compare(image::truthOf(black), black);
  EXPECT_EQ(dark.bias, 1.0);
  EXPECT_EQ(dark.relMse, 0.0);
  EXPECT_TRUE(std::isinf(image::compare(image::truthOf(black), plus(black, 1.f)).bias));
}

TEST(Compare, BlockMeansForgiveNoiseButNotBias) {
  const image::Image truth = plus(image::Image{64, 64, 3, std::vector<float>(64 * 64 * 3)}, 1.f);
  std::mt19937 random(1);
  const image::Comparison noise = image::compare(image::truthOf(truth), noisy(truth, 0.1f, random), 0.5f);
  const image::Comparison bias = image::compare(image::truthOf(truth), plus(truth, 0.1f), 0.5f);
  EXPECT_GT(noise.psnrBlocks, noise.psnr + 10.0) << "the mean of 16 pixels has a sixteenth of their variance: 12 dB";
  EXPECT_NEAR(bias.psnrBlocks, bias.psnr, 0.01);
  EXPECT_EQ(noise.exposure, 0.5);
}

TEST(Compare, HalvesTakeTheReferencesNoiseOut) {
  // The test image is off by 0.3 everywhere; the halves are noisier than that.
  const image::Image truth = ramp(96, 64);
  std::mt19937 random(2);
  const image::Truth halves = image::truthOf(noisy(truth, 1.f, random), noisy(truth, 1.f, random));
  const image::Comparison c = image::compare(halves, plus(truth, 0.3f));
  ASSERT_TRUE(c.uncertainty);
  EXPECT_GT(c.plainRmse, 0.7) << "its noise counts against the mean";
  EXPECT_NEAR(c.mse, 0.09, 4 * c.uncertainty->mseError);
  EXPECT_LT(c.uncertainty->mseError, 0.03);
  EXPECT_LE(c.uncertainty->rmseLow, c.rmse);
  EXPECT_GE(c.uncertainty->rmseHigh, c.rmse);
  // Variance 1 + 1/4 a channel and half, so 5/8 of their mean.
  EXPECT_NEAR(c.uncertainty->floorRmse, std::sqrt(0.625), 0.02);
  EXPECT_NEAR(c.plainRmse * c.plainRmse, c.mse + 0.625, 0.05);
  EXPECT_NEAR(c.bias, 1.0 + 0.3 / c.meanReference, 4 * c.uncertainty->biasError);
  EXPECT_NEAR(c.uncertainty->psnrHalves, image::psnr(halves.a, halves.b, static_cast<float>(c.exposure)), 1e-9);
}

TEST(Compare, IntervalsHoldAsOftenAsTheySay) {
  // 400 references of the same scene: how often does mse ± 1.96 standard errors hold the true MSE, and bias likewise?
  const image::Image truth = ramp(24, 16);
  const image::Image test = plus(image::scaled(truth, 1.02f), -0.2f);
  const image::Comparison exact = image::compare(image::truthOf(truth), test);
  std::mt19937 random(3);
  int mseHeld = 0, biasHeld = 0;
  double sum = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    const image::Comparison c = image::compare(image::truthOf(noisy(truth, 0.5f, random), noisy(truth, 0.5f, random)), test);
    mseHeld += std::abs(c.mse - exact.mse) < 1.96 * c.uncertainty->mseError;
    biasHeld += std::abs(c.bias - exact.bias) < 1.96 * c.uncertainty->biasError;
    sum += c.mse;
    EXPECT_NEAR(c.uncertainty->floorRmse, std::sqrt(0.5 * 0.25 * 1.25), 0.05);
  }
  // 95 % of 400, plus or minus 3.5 standard deviations (1.1 %).
  EXPECT_NEAR(mseHeld / static_cast<double>(kTrials), 0.95, 0.04);
  EXPECT_NEAR(biasHeld / static_cast<double>(kTrials), 0.95, 0.04);
  EXPECT_NEAR(sum / kTrials, exact.mse, 0.02 * exact.mse) << "unbiased";
}

TEST(Compare, HalvesOfUnequalSamplesAreWeighted) {
  const image::Image truth = ramp(96, 64);
  std::mt19937 random(4);
  // A quarter of the samples: twice the deviation of the whole, the rest 2/√3 of it.
  const image::Image a = noisy(truth, 1.f, random), b = noisy(truth, 1.f / std::sqrt(3.f), random);
  const image::Truth halves = image::truthOf(a, b, 0.25);
  EXPECT_NEAR(halves.mean.data[5], 0.25f * a.data[5] + 0.75f * b.data[5], 1e-5f);
  const image::Comparison c = image::compare(halves, truth);
  EXPECT_NEAR(c.uncertainty->floorRmse, std::sqrt(1.25 * 0.25), 0.02);
  EXPECT_NEAR(c.mse, 0.0, 4 * c.uncertainty->mseError);
  EXPECT_EQ(c.rmse, std::sqrt(std::max(c.mse, 0.0)));
  for (const double share : {0.0, 1.0, -1.0, std::nan("")}) {
    EXPECT_NE(errorOf([&] { image::truthOf(a, b, share); }).find("shares"), std::string::npos);
  }
}

TEST(Compare, WhatCannotBeComparedIsNamed) {
  const image::Image good = ramp(8, 6);
  EXPECT_NE(errorOf([&] { image::checkComparable(good, ramp(9, 6), "r.exr", "t.exr"); }).find("t.exr is 9x6 with 3 channels"),
            std::string::npos);
  image::Image bad = good;
  bad.at(7, 5, 2) = std::nanf("");
  const std::string place = "t.exr: pixel (7, 5), channel 2, is not a number";
  EXPECT_NE(errorOf([&] { image::checkComparable(good, bad, "r.exr", "t.exr"); }).find(place), std::string::npos);
  EXPECT_NE(errorOf([&] { image::checkComparable(bad, good, "r.exr", "t.exr"); }).find("r.exr: pixel (7, 5)"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::truthOf(good, bad); }).find("second half: pixel (7, 5)"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::truthOf(bad); }).find("(7, 5)"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::compare(image::truthOf(good), bad); }).find("(7, 5)"), std::string::npos);
  bad.at(7, 5, 2) = -std::numeric_limits<float>::infinity();
  EXPECT_NE(errorOf([&] { image::compare(image::truthOf(good), bad); }).find("infinite"), std::string::npos);
}

TEST(Compare, PercentilesInterpolate) {
  EXPECT_EQ(image::percentileOf({3.0}, 0.99), 3.0);
  EXPECT_DOUBLE_EQ(image::percentileOf({3.0, 1.0}, 0.25), 1.5);
  EXPECT_EQ(image::percentileOf({4.0, 1.0, 3.0, 2.0, 0.0}, 0.5), 2.0);
  EXPECT_EQ(image::percentileOf({4.0, 1.0, 3.0}, 1.0), 4.0);
}

TEST(Compare, HeatGrowsBrighter) {
  image::Image map{256, 1, 1, {}};
  for (int i = 0; i < 256; ++i) map.data.push_back(static_cast<float>(i) / 255.f);
  const image::Image painted = image::paintHeat(map);
  double before = -1;
  for (uint32_t x = 0; x < 256; ++x) {
    const double luminance = 0.2126 * static_cast<double>(painted.at(x, 0, 0)) + 0.7152 * static_cast<double>(painted.at(x, 0, 1)) +
                             0.0722 * static_cast<double>(painted.at(x, 0, 2));
    EXPECT_GT(luminance, before) << x;
    before = luminance;
  }
  EXPECT_EQ(painted.at(0, 0, 0), 0.f);
  EXPECT_EQ(image::paintHeat(image::Image{2, 1, 1, {-5.f, 9.f}}).at(1, 0, 0), 1.f);
}

}  // namespace
