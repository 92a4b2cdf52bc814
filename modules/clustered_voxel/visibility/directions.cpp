#include "modules/clustered_voxel/visibility/directions.h"

#include <cmath>
#include <numbers>

#include "shaders/clustered_voxel/visibility/visibility.h"

namespace radivox::clustered_voxel {

std::vector<uint32_t> makeDirections(uint32_t rayCount) {
  const double golden = 1.0 / std::numbers::phi;
  // A cell of the spiral lattice that is about as wide as it is high: a Fibonacci number's worth of steps in u, its share of a turn.
  uint32_t steps = 1;
  for (uint32_t next = 2; next <= rayCount && next * next <= 2.0 * std::numbers::pi * rayCount;) {
    const uint32_t after = steps + next;
    steps = next;
    next = after;
  }
  std::vector<uint32_t> directions;
  directions.reserve(size_t{rayCount} * shared::kShiftCount);
  for (uint32_t shift = 0; shift < shared::kShiftCount; ++shift) {
    // The shifts are a low-discrepancy set of their own: by bit reversal in one coordinate, even in the other.
    uint32_t reversed = 0;
    for (uint32_t bit = 1; bit < shared::kShiftCount; bit *= 2) reversed = 2 * reversed + ((shift & bit) != 0 ? 1 : 0);
    const double along = steps * (reversed + 0.5) / shared::kShiftCount;
    const double across = (shift + 0.5) / shared::kShiftCount / steps;
    for (uint32_t ray = 0; ray < rayCount; ++ray) {
      const double radius2 = std::fmod(ray + along, static_cast<double>(rayCount)) / rayCount;
      const double turn = ray * golden + across;
      const double azimuth = 2.0 * std::numbers::pi * (turn - std::floor(turn));
      const double radius = std::sqrt(radius2);
      const auto code = [](double coordinate) { return static_cast<uint32_t>(std::lround((coordinate + 1.0) * 0.5 * 65535.0)); };
      directions.push_back(code(radius * std::cos(azimuth)) | code(radius * std::sin(azimuth)) << 16);
    }
  }
  return directions;
}

}  // namespace radivox::clustered_voxel
