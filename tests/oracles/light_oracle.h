// Rays and direct light in double precision, by brute force over all triangles, from the definitions of METHODS section 0.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "engine/scene/scene.h"

namespace radivox::oracles {

struct RayHit {
  uint32_t triangle = 0;
  double t = 0;
  glm::dvec3 barycentric{0.0};  ///< weights of the three corners
  double edge = 0;              ///< least weight: how near an edge passes
};

class LightOracle {
 public:
  explicit LightOracle(const scene::Scene& scene);

  /// Nearest hit with tMin < t, both sides of every triangle.
  std::optional<RayHit> castRay(const glm::dvec3& origin, const glm::dvec3& direction, double tMin = 0) const;
  /// Does anything cut the open segment, `margin` (a share of its length) from each end?
  bool isBlocked(const glm::dvec3& from, const glm::dvec3& to, double margin = 1e-6) const;
  bool isBlockedAlong(const glm::dvec3& from, const glm::dvec3& direction, double tMin = 1e-6) const;

  glm::dvec3 corner(uint32_t triangle, int k) const;
  glm::dvec3 normal(uint32_t triangle) const;  ///< unit, counter-clockwise side
  size_t triangleCount() const { return corners_.size(); }

  /// Irradiance at p from the scene's punctual lights on a surface with shading normal n and geometric normal g, shadowed or not.
  glm::dvec3 punctualIrradiance(const glm::dvec3& p, const glm::dvec3& n, const glm::dvec3& g, bool shadowed) const;
  /// Irradiance from emissive triangles: each is cut into 4^level pieces, which are cast to at their centres.
  glm::dvec3 emitterIrradiance(const glm::dvec3& p, const glm::dvec3& n, const glm::dvec3& g, int level, bool shadowed) const;

  /// The ray through a point of the image, in pixels from the top left corner: from the camera's definition, not from its matrices.
  static void cameraRay(const scene::CameraDescription& camera, uint32_t width, uint32_t height, double x, double y, glm::dvec3& origin,
                        glm::dvec3& direction);

 private:
  const scene::Scene& scene_;
  std::vector<std::array<glm::dvec3, 3>> corners_;
};

}  // namespace radivox::oracles
