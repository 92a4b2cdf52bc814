#include <cmath>
#include <limits>

#include "engine/error.h"
#include "engine/image/compare.h"

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
  const double percentile = percentileOf(std::move(luminance), 0.99);
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
  checkComparable(reference, test);
  return psnr(reference, test, exposureOf(reference));
}

double psnr(const Image& reference, const Image& test, float exposure) {
  checkComparable(reference, test);
  double sum = 0.0;
  for (size_t i = 0; i < reference.data.size(); ++i) {
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
