#include "engine/scene/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.h"
#include "engine/scene/sky_suns.h"
#include "engine/text.h"
#include "shaders/shared/sky.h"

namespace radivox::scene {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Bins are cut out of the image by this many points at least along its equator, so that texels on their borders count in parts.
constexpr uint32_t kBinColumns = 2048;

void checkTexels(const image::Image& image, const std::string& name) {
  if (image.channels < 3) throw Error(ErrorCode::BadInput, name + ": it has no red, green and blue; save it as an RGB image");
  if (image.width != 2 * image.height || image.width < 8) {
    throw Error(ErrorCode::BadInput, name + ": it is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                                         " pixels; an equirectangular sky is twice as wide as high, and 8x4 at least");
  }
  for (size_t i = 0; i < size_t{image.width} * image.height; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = image.data[i * image.channels + c];
      if (std::isfinite(value) && value >= 0.f) continue;
      throw Error(ErrorCode::BadInput, name + ": texel " + std::to_string(i % image.width) + "," + std::to_string(i / image.width) +
                                           " is " + printNumber(static_cast<double>(value)) +
                                           "; radiance is finite and not negative: mend the image");
    }
  }
}

/// Mean over 2×2 texels; the solid angles of two rows side by side differ by nothing that matters at this size.
void halve(Sky& sky) {
  const uint32_t width = sky.width / 2, height = sky.height / 2;
  std::vector<glm::vec3> half(size_t{width} * height);
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const glm::vec3* top = &sky.texels[2 * y * sky.width + 2 * x];
      half[y * width + x] = 0.25f * (top[0] + top[1] + top[sky.width] + top[sky.width + 1]);
    }
  }
  sky.texels = std::move(half);
  sky.width = width;
  sky.height = height;
}

/// Sums by solid angle, and their mean.
struct Means {
  explicit Means(size_t count) : sums(count), weights(count) {}
  void add(size_t i, const glm::vec3& value, double weight) {
    sums[i] += weight * glm::dvec3(value);
    weights[i] += weight;
  }
  std::vector<glm::vec3> finish() const {
    std::vector<glm::vec3> means;
    for (size_t i = 0; i < sums.size(); ++i) means.emplace_back(sums[i] / weights[i]);
    return means;
  }
  std::vector<glm::dvec3> sums;
  std::vector<double> weights;
};

/// Parts of texels, each with its solid angle and the direction of its middle.
void collectMeans(Sky& sky, const std::vector<glm::vec3>& calm) {
  const uint32_t parts = std::max(1u, (kBinColumns + sky.width - 1) / sky.width);
  const uint32_t columns = sky.width * parts, rows = sky.height * parts;
  Means bins(shared::kSkyBinCount), cells(size_t{shared::kSkyCellColumns} * shared::kSkyCellRows);
  for (uint32_t y = 0; y < rows; ++y) {
    const double v = (y + 0.5) / rows;
    const double weight = std::cos(kPi * y / rows) - std::cos(kPi * (y + 1) / rows);
    const auto cellRow = static_cast<uint32_t>(v * shared::kSkyCellRows);
    for (uint32_t x = 0; x < columns; ++x) {
      const double u = (x + 0.5) / columns;
      const glm::vec3& value = calm[size_t{y / parts} * sky.width + x / parts];
      bins.add(shared::skyBin(glm::vec3(sky.direction(u, v)), true), value, weight);
      cells.add(size_t{cellRow} * shared::kSkyCellColumns + static_cast<uint32_t>(u * shared::kSkyCellColumns), value, weight);
    }
  }
  sky.bins = bins.finish();
  sky.cells = cells.finish();
}

}  // namespace

glm::dvec3 Sky::direction(double u, double v) const {
  const double azimuth = 2 * kPi * (u - 0.5) - static_cast<double>(turn), polar = kPi * v;
  return {std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)};
}

namespace {

glm::dvec2 placeOf(const Sky& sky, const glm::vec3& d) {
  const double u = 0.5 + (std::atan2(static_cast<double>(d.x), -static_cast<double>(d.z)) + static_cast<double>(sky.turn)) / (2 * kPi);
  return {u - std::floor(u), std::acos(std::clamp(static_cast<double>(d.y), -1.0, 1.0)) / kPi};
}

}  // namespace

glm::uvec2 Sky::texelAt(const glm::vec3& d) const {
  const glm::dvec2 place = placeOf(*this, d);
  return {std::min(static_cast<uint32_t>(place.x * width), width - 1), std::min(static_cast<uint32_t>(place.y * height), height - 1)};
}

glm::vec3 Sky::radiance(const glm::vec3& d) const {
  const glm::uvec2 at = texelAt(d);
  return texels[size_t{at.y} * width + at.x];
}

glm::vec3 Sky::interpolated(const glm::vec3& d) const {
  const glm::dvec2 place = placeOf(*this, d) * glm::dvec2(width, height) - 0.5;
  const glm::dvec2 corner = glm::floor(place);
  const glm::vec2 share(place - corner);
  const auto texel = [&](int dx, int dy) {
    const int64_t x = static_cast<int64_t>(corner.x) + dx, y = static_cast<int64_t>(corner.y) + dy;
    return texels[static_cast<size_t>(std::clamp<int64_t>(y, 0, height - 1)) * width + static_cast<size_t>((x + width) % width)];
  };
  return glm::mix(glm::mix(texel(0, 0), texel(1, 0), share.x), glm::mix(texel(0, 1), texel(1, 1), share.x), share.y);
}

double Sky::solidAngle(uint32_t row) const { return (std::cos(kPi * row / height) - std::cos(kPi * (row + 1) / height)) * 2 * kPi / width; }

std::shared_ptr<const Sky> makeSky(const image::Image& image, const std::string& name, double scale, double turn, Suns suns) {
  checkTexels(image, name);
  auto sky = std::make_shared<Sky>();
  sky->width = image.width;
  sky->height = image.height;
  sky->turn = static_cast<float>(std::remainder(turn, 360.0) * kPi / 180);
  sky->texels.resize(size_t{image.width} * image.height);
  for (size_t i = 0; i < sky->texels.size(); ++i) {
    const float* from = &image.data[i * image.channels];
    sky->texels[i] = glm::vec3(glm::dvec3(from[0], from[1], from[2]) * scale);
  }
  if (sky->width > kMostSkyWidth) {
    sky->notes.push_back(name + ": " + std::to_string(image.width) + " texels wide; halved until " + std::to_string(kMostSkyWidth) +
                         " or fewer are left");
    while (sky->width > kMostSkyWidth) halve(*sky);
  }
  collectMeans(*sky, suns == Suns::TakeOut ? takeOutSuns(*sky, name) : sky->texels);
  return sky;
}

}  // namespace radivox::scene
