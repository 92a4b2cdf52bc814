// Shadow views that no face is in.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/light_setup.h"

namespace radivox::scene {

namespace {

constexpr size_t kRun = 64;                // triangles that share a box
constexpr uint64_t kMostTests = 1u << 28;  // of views against boxes: above it the search costs more than it saves
constexpr double kMargin = 0.01;           // of a view's half width: what lies just beside it counts as in it

struct Box {
  glm::dvec3 min{std::numeric_limits<double>::max()}, max{std::numeric_limits<double>::lowest()};
  void add(const glm::dvec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
};

glm::dvec3 corner(const Scene& scene, size_t index) { return glm::dvec3(scene.vertices[scene.indices[index]].position); }

std::vector<Box> boxRuns(const Scene& scene) {
  std::vector<Box> boxes((scene.triangleCount() + kRun - 1) / kRun);
  for (size_t i = 0; i < scene.indices.size(); ++i) boxes[i / (3 * kRun)].add(corner(scene, i));
  return boxes;
}

/// The half-spaces beyond a view: a·p + b > 0 lies outside.
class Frustum {
 public:
  Frustum(const shared::ShadowView& view, double allowance) : allowance_(allowance) {
    const glm::dmat4 rows = glm::transpose(glm::dmat4(view.viewProjection));
    for (int axis = 0; axis < 2; ++axis) {
      planes_[2 * axis] = rows[axis] - (1.0 + kMargin) * rows[3];
      planes_[2 * axis + 1] = -rows[axis] - (1.0 + kMargin) * rows[3];
    }
    planes_[4] = -rows[3];
  }
  bool isOutside(const Box& box) const {
    return std::any_of(std::begin(planes_), std::end(planes_), [&](const glm::dvec4& plane) {
      const glm::dvec3 a(plane);
      const glm::dvec3 innermost(a.x > 0 ? box.min.x : box.max.x, a.y > 0 ? box.min.y : box.max.y, a.z > 0 ? box.min.z : box.max.z);
      return glm::dot(a, innermost) + plane.w > allowance_;
    });
  }
  bool isOutside(const Scene& scene, size_t triangle) const {
    return std::any_of(std::begin(planes_), std::end(planes_), [&](const glm::dvec4& plane) {
      double least = std::numeric_limits<double>::max();
      for (size_t k = 0; k < 3; ++k) least = std::min(least, glm::dot(glm::dvec3(plane), corner(scene, 3 * triangle + k)) + plane.w);
      return least > allowance_;
    });
  }

 private:
  glm::dvec4 planes_[5];
  double allowance_;
};

bool isDark(const Scene& scene, const std::vector<Box>& boxes, const Frustum& frustum) {
  for (size_t run = 0; run < boxes.size(); ++run) {
    if (frustum.isOutside(boxes[run])) continue;
    const size_t end = std::min(scene.triangleCount(), (run + 1) * kRun);
    for (size_t triangle = run * kRun; triangle < end; ++triangle) {
      if (!frustum.isOutside(scene, triangle)) return false;
    }
  }
  return true;
}

double diagonalOf(const Traits& traits) { return glm::distance(glm::dvec3(traits.boundsMin), glm::dvec3(traits.boundsMax)); }

}  // namespace

bool endsBefore(const Traits& traits, const shared::Light& light) {
  if (light.type == shared::kLightDirectional || light.range <= 0.f) return false;
  const glm::dvec3 at(light.position);
  const glm::dvec3 nearest = glm::clamp(at, glm::dvec3(traits.boundsMin), glm::dvec3(traits.boundsMax));
  return glm::distance(at, nearest) > 1.0001 * static_cast<double>(light.range) + 1e-5 * diagonalOf(traits);
}

std::vector<bool> findDarkViews(const Scene& scene, const Traits& traits, const std::vector<shared::Light>& lights,
                                const std::vector<shared::ShadowView>& views) {
  std::vector<bool> dark(views.size(), false);
  const std::vector<Box> boxes = boxRuns(scene);
  const bool searches = static_cast<uint64_t>(boxes.size()) * views.size() <= kMostTests;
  const double allowance = 1e-4 * diagonalOf(traits);
  for (size_t i = 0; i < views.size(); ++i) {
    const shared::Light& light = lights[views[i].light];
    // A directional view is made about the scene.
    if (light.type == shared::kLightDirectional) continue;
    dark[i] = endsBefore(traits, light) || (searches && isDark(scene, boxes, Frustum(views[i], allowance)));
  }
  return dark;
}

}  // namespace radivox::scene
