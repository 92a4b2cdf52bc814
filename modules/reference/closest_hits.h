// Closest hits of given rays, by Embree alone: the yardstick for the speed of voxel rays (`radivox bench`). No materials: alpha masks are not cut out,
// and all sides are there. Every liberty that Embree offers is taken (spatial splits, no watertight edges).
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace radivox::reference {

class ClosestHits {
 public:
  struct Ray {
    glm::vec3 origin, direction;  ///< m; distances are in lengths of `direction`
  };
  /// One ray at a time, packets, or a stream of 256 rays, said to be coherent.
  enum class Way { Single, Packet4, Packet8, Packet16, Stream };
  static std::string_view name(Way way);

  /// `scene` must outlive it.
  explicit ClosestHits(const scene::Scene& scene);
  ~ClosestHits();
  ClosestHits(const ClosestHits&) = delete;
  ClosestHits& operator=(const ClosestHits&) = delete;

  /// Those that this processor runs as such.
  std::vector<Way> ways() const;
  /// How far each ray goes; negative: nothing was hit. `threads` 0: all. Returns the seconds it took, from rays in memory to distances in memory.
  double trace(std::span<const Ray> rays, std::span<float> distances, Way way, uint32_t threads = 0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace radivox::reference
