#include "modules/clustered_voxel/voxelize/grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/error.h"

namespace radivox::clustered_voxel {

shared::Grid makeGrid(const glm::vec3& boundsMin, const glm::vec3& boundsMax, uint32_t resolution) {
  const glm::dvec3 low(boundsMin), high(boundsMax);
  const glm::dvec3 extent = glm::max(high - low, glm::dvec3(0.0));
  const double longest = std::max({extent.x, extent.y, extent.z});
  // Below 1e-30 m the reciprocal of the edge is no float any more; such a scene is a point.
  const bool isPoint = !(longest > 1e-30);
  // The float edge that the shaders multiply by, and not the ideal one, decides what fits.
  shared::Grid grid{};
  grid.h = isPoint ? 1.f : static_cast<float>(longest / (resolution - 1.0));
  grid.inverseH = isPoint ? 1.f : static_cast<float>((resolution - 1.0) / longest);
  const double h = isPoint ? 1.0 : longest / (resolution - 1.0);
  for (int k = 0; k < 3; ++k) {
    // 1e-6: an extent of k edges up to rounding is k edges; the margin of half a voxel bears it.
    const double edges = isPoint ? 0.0 : std::ceil(extent[k] / h - 1e-6);
    grid.size[k] = std::min(static_cast<uint32_t>(std::max(edges, 0.0)) + 1u, resolution);
    grid.origin[k] = static_cast<float>(0.5 * (low[k] + high[k]) - 0.5 * grid.size[k] * h);
    grid.bricks[k] = (grid.size[k] + 3) / 4;
  }
  grid.brickCount = grid.bricks.x * grid.bricks.y * grid.bricks.z;
  return grid;
}

shared::Grid makeGrid(const scene::Traits& traits, uint32_t resolution) { return makeGrid(traits.boundsMin, traits.boundsMax, resolution); }

shared::Grid makeGridWithin(const scene::Traits& traits, uint32_t resolution, uint64_t maxStorageBufferRange, const char* owner) {
  const shared::Grid grid = makeGrid(traits, resolution);
  const auto bytesOf = [](const shared::Grid& g) { return static_cast<uint64_t>(g.brickCount) * 8; };
  if (maxStorageBufferRange == 0 || bytesOf(grid) <= maxStorageBufferRange) return grid;
  uint32_t low = 2, high = resolution;  // low fits, high does not
  while (high - low > 1) {
    const uint32_t middle = (low + high) / 2;
    (bytesOf(makeGrid(traits, middle)) <= maxStorageBufferRange ? low : high) = middle;
  }
  throw Error(ErrorCode::OutOfMemory, std::string(owner) + "=" + std::to_string(resolution) + ": occupancy needs " +
                                          std::to_string(bytesOf(grid)) + " bytes, and this device binds at most " +
                                          std::to_string(maxStorageBufferRange) + "; use " + owner + "=" + std::to_string(low) +
                                          " or less");
}

}  // namespace radivox::clustered_voxel
