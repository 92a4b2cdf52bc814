#include "modules/reference/sky_distribution.h"

#include <algorithm>
#include <cmath>

namespace radivox::reference {

namespace {

constexpr double kPi = 3.14159265358979323846;

double luminanceOf(const glm::vec3& c) {
  return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
}

/// Which of `count` steps of a cumulative table holds u, which becomes its place within the step.
size_t choose(const double* cumulative, size_t count, double& u) {
  const double at = u * cumulative[count - 1];
  const auto i = std::min(static_cast<size_t>(std::upper_bound(cumulative, cumulative + count, at) - cumulative), count - 1);
  const double before = i > 0 ? cumulative[i - 1] : 0.0;
  u = cumulative[i] > before ? std::clamp((at - before) / (cumulative[i] - before), 0.0, 1.0) : 0.5;
  return i;
}

}  // namespace

SkyDistribution::SkyDistribution(const scene::Sky& sky) {
  columns_.reserve(sky.texels.size());
  for (uint32_t y = 0; y < sky.height; ++y) {
    double row = 0;
    for (uint32_t x = 0; x < sky.width; ++x) {
      row += luminanceOf(sky.texels[size_t{y} * sky.width + x]);
      columns_.push_back(row);
    }
    flux_ += row * sky.solidAngle(y);
    rows_.push_back(flux_);
  }
}

SkySample SkyDistribution::sample(const scene::Sky& sky, double u, double v) const {
  SkySample sample;
  if (!(flux_ > 0)) return sample;
  const size_t y = choose(rows_.data(), rows_.size(), v);
  const size_t x = choose(&columns_[y * sky.width], sky.width, u);
  const double top = std::cos(kPi * static_cast<double>(y) / sky.height), bottom = std::cos(kPi * static_cast<double>(y + 1) / sky.height);
  const double polar = std::acos(std::clamp(top + v * (bottom - top), -1.0, 1.0));
  sample.direction = glm::vec3(sky.direction((static_cast<double>(x) + u) / sky.width, polar / kPi));
  sample.radiance = sky.texels[y * sky.width + x];
  sample.density = density(sample.radiance);
  return sample;
}

double SkyDistribution::density(const glm::vec3& radiance) const { return flux_ > 0 ? luminanceOf(radiance) / flux_ : 0.0; }

}  // namespace radivox::reference
