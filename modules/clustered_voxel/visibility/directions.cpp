#include "modules/clustered_voxel/visibility/directions.h"

#include <cmath>
#include <numbers>

#include "shaders/clustered_voxel/visibility/visibility.h"

namespace radivox::clustered_voxel {

std::vector<glm::vec3> makeDirections(uint32_t rayCount) {
  const double golden = 1.0 / std::numbers::phi;
  std::vector<glm::vec3> directions;
  directions.reserve(size_t{rayCount} * shared::kRotationCount);
  for (uint32_t rotation = 0; rotation < shared::kRotationCount; ++rotation) {
    // Bit reversal: the place within the stratum is not in step with the azimuth.
    uint32_t reversed = 0;
    for (uint32_t bit = 1; bit < shared::kRotationCount; bit *= 2) reversed = 2 * reversed + ((rotation & bit) != 0 ? 1 : 0);
    const double place = (reversed + 0.5) / shared::kRotationCount;
    for (uint32_t ray = 0; ray < rayCount; ++ray) {
      const double radius2 = (ray + place) / rayCount;
      const double turn = ray * golden + static_cast<double>(rotation) / shared::kRotationCount;
      const double azimuth = 2.0 * std::numbers::pi * (turn - std::floor(turn));
      const double radius = std::sqrt(radius2);
      directions.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), std::sqrt(1.0 - radius2));
    }
  }
  return directions;
}

}  // namespace radivox::clustered_voxel
