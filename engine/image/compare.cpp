#include "engine/image/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/error.h"

namespace radivox::image {

namespace {

constexpr uint32_t kBlock = 4;
constexpr double kTwoSided95 = 1.959964;

std::string printShape(const Image& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height) + " with " + std::to_string(image.channels) +
         (image.channels == 1 ? " channel" : " channels");
}

void checkFinite(const Image& image, const std::string& name) {
  for (size_t i = 0; i < image.data.size(); ++i) {
    if (std::isfinite(image.data[i])) continue;
    const size_t pixel = i / image.channels;
    throw Error(ErrorCode::BadInput, name + ": pixel (" + std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
                                         "), channel " + std::to_string(i % image.channels) + ", is " +
                                         (std::isnan(image.data[i]) ? "not a number" : "infinite") + "; mend the image first");
  }
}

double square(double x) { return x * x; }

/// 0 over 0 is no error.
double ratio(double above, double below) {
  if (below > 0.0) return above / below;
  return above == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), above);
}

double psnrOfBlocks(const Image& reference, const Image& test, float exposure) {
  if (reference.width < kBlock || reference.height < kBlock) return std::numeric_limits<double>::quiet_NaN();
  return psnr(blockMeans(reference, kBlock), blockMeans(test, kBlock), exposure);
}

Uncertainty measureUncertainty(const Truth& truth, const Image& test, const Comparison& c) {
  const Image &a = truth.a, &b = truth.b, &mean = truth.mean;
  const double shareA = truth.shareOfA, shareB = 1.0 - shareA;
  // E[(a − b)²] = σ²(1/shareA + 1/shareB) and the mean's variance is σ²: hence this factor, 1/4 for equal halves.
  const double varianceOfMean = shareA * shareB;
  const double count = static_cast<double>(mean.data.size());
  const double epsilon = 0.01 * square(c.meanReference);
  double mseVariance = 0, meanVariance = 0, floor = 0, relFloor = 0;
  for (uint64_t pixel = 0; pixel < c.pixelCount; ++pixel) {
    // Channels of a pixel share their paths: their noise adds before it is squared. With centre h = (a + b)/2 and d = a − b, d²(m − h)² has
    // the expectation of Var[(m − a)(m − b)] for Gaussian noise of equal halves, 2e²σ² + σ⁴ with e = m − truth; a little more for unequal.
    double product = 0, sum = 0;
    for (uint32_t channel = 0; channel < mean.channels; ++channel) {
      const size_t i = pixel * mean.channels + channel;
      const double d = static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]);
      const double centre = 0.5 * (static_cast<double>(a.data[i]) + static_cast<double>(b.data[i]));
      product += d * (static_cast<double>(test.data[i]) - centre);
      sum += d;
      const double noise = varianceOfMean * d * d;
      floor += noise;
      relFloor += ratio(noise, square(static_cast<double>(mean.data[i])) + epsilon);
    }
    mseVariance += square(product);
    meanVariance += varianceOfMean * square(sum);
  }
  Uncertainty u;
  u.mseError = std::sqrt(mseVariance) / count;
  u.biasError = c.bias * ratio(std::sqrt(meanVariance) / count, std::abs(c.meanReference));
  u.rmseLow = std::sqrt(std::max(c.mse - kTwoSided95 * u.mseError, 0.0));
  u.rmseHigh = std::sqrt(std::max(c.mse + kTwoSided95 * u.mseError, 0.0));
  u.floorRmse = std::sqrt(floor / count);
  u.floorRelMse = relFloor / count;
  u.psnrHalves = psnr(a, b, static_cast<float>(c.exposure));
  u.psnrBlocksHalves = psnrOfBlocks(a, b, static_cast<float>(c.exposure));
  return u;
}

}  // namespace

void checkComparable(const Image& reference, const Image& test, const std::string& referenceName, const std::string& testName) {
  if (reference.width != test.width || reference.height != test.height || reference.channels != test.channels) {
    throw Error(ErrorCode::BadInput, "cannot compare images: " + referenceName + " is " + printShape(reference) + ", " + testName + " is " +
                                         printShape(test) + "; render both alike");
  }
  if (reference.data.empty()) throw Error(ErrorCode::BadInput, referenceName + ": the image is empty; give images with pixels");
  checkFinite(reference, referenceName);
  checkFinite(test, testName);
}

double percentileOf(std::vector<double> values, double share) {
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), below, values.end());
  const double fraction = rank - std::floor(rank);
  return fraction > 0.0 ? *below + fraction * (*std::min_element(below + 1, values.end()) - *below) : *below;
}

Truth truthOf(Image reference) {
  checkComparable(reference, reference);
  Truth truth;
  truth.mean = std::move(reference);
  return truth;
}

Truth truthOf(Image a, Image b, double shareOfA) {
  checkComparable(a, b, "the reference's first half", "its second half");
  if (!(shareOfA > 0.0 && shareOfA < 1.0)) {
    throw Error(ErrorCode::BadInput, "halves of a reference need some samples each; give shares above 0");
  }
  Truth truth{a, std::move(a), std::move(b), shareOfA};
  for (size_t i = 0; i < truth.mean.data.size(); ++i) {
    const double value = shareOfA * static_cast<double>(truth.a.data[i]) + (1.0 - shareOfA) * static_cast<double>(truth.b.data[i]);
    truth.mean.data[i] = static_cast<float>(value);
  }
  return truth;
}

Comparison compare(const Truth& truth, const Image& test, std::optional<float> exposure) {
  const Image& mean = truth.mean;
  checkComparable(mean, test);
  Comparison c;
  c.pixelCount = static_cast<uint64_t>(mean.width) * mean.height;
  c.meanReference = meanOf(mean);
  c.meanTest = meanOf(test);
  c.bias = c.meanReference == c.meanTest ? 1.0 : ratio(c.meanTest, c.meanReference);
  const double count = static_cast<double>(mean.data.size());
  const double epsilon = 0.01 * square(c.meanReference);
  double plain = 0;
  for (size_t i = 0; i < mean.data.size(); ++i) {
    const double t = static_cast<double>(test.data[i]), r = static_cast<double>(mean.data[i]);
    const double difference = square(t - r);
    const double unbiased =
        truth.hasHalves() ? (t - static_cast<double>(truth.a.data[i])) * (t - static_cast<double>(truth.b.data[i])) : difference;
    plain += difference;
    c.mse += unbiased;
    c.relMse += ratio(unbiased, square(r) + epsilon);
  }
  c.mse /= count;
  c.relMse /= count;
  c.rmse = std::sqrt(std::max(c.mse, 0.0));
  c.plainRmse = std::sqrt(plain / count);
  const float factor = exposure.value_or(exposureOf(mean));
  c.exposure = static_cast<double>(factor);
  c.psnr = psnr(mean, test, factor);
  c.psnrBlocks = psnrOfBlocks(mean, test, factor);
  if (truth.hasHalves()) c.uncertainty = measureUncertainty(truth, test, c);
  return c;
}

Image paintHeat(const Image& map) {
  constexpr std::array<std::array<float, 3>, 5> kStops = {
      {{0.f, 0.f, 0.f}, {0.28f, 0.08f, 0.46f}, {0.74f, 0.17f, 0.38f}, {0.97f, 0.53f, 0.18f}, {1.f, 0.97f, 0.76f}}};
  Image painted{map.width, map.height, 3, {}};
  painted.data.reserve(map.data.size() * 3);
  for (const float value : map.data) {
    const float at = std::clamp(value, 0.f, 1.f) * static_cast<float>(kStops.size() - 1);
    const size_t low = std::min(static_cast<size_t>(at), kStops.size() - 2);
    const float fraction = at - static_cast<float>(low);
    for (size_t c = 0; c < 3; ++c) {
      painted.data.push_back(decodeSrgb((1.f - fraction) * kStops[low][c] + fraction * kStops[low + 1][c]));
    }
  }
  return painted;
}

}  // namespace radivox::image
