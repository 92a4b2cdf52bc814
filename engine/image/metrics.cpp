#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/error.h"
#include "engine/image/image.h"

namespace radivox::image {

namespace {

/// Luminance of linear Rec. 709; a single channel is its own luminance.
double luminanceAt(const Image& image, size_t pixel) {
  const float* p = image.data.data() + pixel * image.channels;
  if (image.channels < 3) return static_cast<double>(p[0]);
  return 0.2126 * static_cast<double>(p[0]) + 0.7152 * static_cast<double>(p[1]) + 0.0722 * static_cast<double>(p[2]);
}

}  // namespace

float exposureOf(const Image& linear) {
  std::vector<double> luminance;
  const size_t pixelCount = static_cast<size_t>(linear.width) * linear.height;
  luminance.reserve(pixelCount);
  for (size_t i = 0; i < pixelCount; ++i) {
    const double value = luminanceAt(linear, i);
    if (std::isfinite(value)) luminance.push_back(value);
  }
  if (luminance.empty()) return 1.f;
  const double rank = 0.99 * static_cast<double>(luminance.size() - 1);
  const auto below = luminance.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(luminance.begin(), below, luminance.end());
  double percentile = *below;
  const double fraction = rank - std::floor(rank);
  if (fraction > 0.0) percentile += fraction * (*std::min_element(below + 1, luminance.end()) - *below);
  const double factor = 1.0 / percentile;
  return percentile > 0.0 && factor <= static_cast<double>(std::numeric_limits<float>::max()) ? static_cast<float>(factor) : 1.f;
}

Image scaled(const Image& image, float factor) {
  Image result = image;
  for (float& value : result.data) value *= factor;
  return result;
}

Image blockMeans(const Image& image, uint32_t k) {
  Image result;
  if (k == 0) throw Error(ErrorCode::BadInput, "block means need blocks of at least 1 pixel, not 0");
  result.width = image.width / k;
  result.height = image.height / k;
  result.channels = image.channels;
  result.data.resize(static_cast<size_t>(result.width) * result.height * result.channels);
  for (uint32_t y = 0; y < result.height; ++y) {
    for (uint32_t x = 0; x < result.width; ++x) {
      for (uint32_t c = 0; c < result.channels; ++c) {
        double sum = 0.0;
        for (uint32_t j = 0; j < k; ++j) {
          for (uint32_t i = 0; i < k; ++i) sum += static_cast<double>(image.at(x * k + i, y * k + j, c));
        }
        result.at(x, y, c) = static_cast<float>(sum / (static_cast<double>(k) * k));
      }
    }
  }
  return result;
}

double psnr(const Image& reference, const Image& test) {
  if (reference.width != test.width || reference.height != test.height || reference.channels != test.channels) {
    const auto print = [](const Image& i) {
      return std::to_string(i.width) + "x" + std::to_string(i.height) + " with " + std::to_string(i.channels) + " channels";
    };
    throw Error(ErrorCode::BadInput, "cannot compare images of " + print(reference) + " and of " + print(test) + "; render both alike");
  }
  if (reference.data.empty()) throw Error(ErrorCode::BadInput, "cannot compare empty images; give images with pixels");
  const float exposure = exposureOf(reference);
  double sum = 0.0;
  for (size_t i = 0; i < reference.data.size(); ++i) {
    if (std::isnan(reference.data[i]) || std::isnan(test.data[i])) {
      const size_t pixel = i / reference.channels;
      throw Error(ErrorCode::BadInput, "cannot compare images: pixel (" + std::to_string(pixel % reference.width) + ", " +
                                           std::to_string(pixel / reference.width) + ") is not a number; mend the image first");
    }
    const double a = static_cast<double>(encodeSrgb(reference.data[i] * exposure));
    const double b = static_cast<double>(encodeSrgb(test.data[i] * exposure));
    sum += (a - b) * (a - b);
  }
  const double mse = sum / static_cast<double>(reference.data.size());
  return mse > 0.0 ? -10.0 * std::log10(mse) : std::numeric_limits<double>::infinity();
}

double meanOf(const Image& image) {
  if (image.data.empty()) return 0.0;
  double sum = 0.0;
  for (const float value : image.data) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.data.size());
}

}  // namespace radivox::image
