// Directions towards the image of a sky, with a density in proportion to its luminance. Internal to modules/reference.
#pragma once

#include <vector>

#include "engine/scene/sky.h"

namespace radivox::reference {

struct SkySample {
  glm::vec3 direction{0.f, 1.f, 0.f};  ///< unit
  glm::vec3 radiance{0.f};             ///< of the texel there
  double density = 0;                  ///< per sr; 0: the sky is black
};

/// A texel is chosen by its flux, a row first, and then a point evenly over its solid angle.
class SkyDistribution {
 public:
  SkyDistribution() = default;
  explicit SkyDistribution(const scene::Sky& sky);
  SkySample sample(const scene::Sky& sky, double u, double v) const;  ///< u, v in [0, 1)
  double density(const glm::vec3& radiance) const;                    ///< per sr, where the sky's texel has this radiance

 private:
  std::vector<double> rows_, columns_;  ///< cumulative: of all rows; within each row
  double flux_ = 0;
};

}  // namespace radivox::reference
