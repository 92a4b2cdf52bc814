#include "tests/oracles/light_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace radivox::oracles {

namespace {

/// Barycentric weights from signed volumes, t from the plane.
std::optional<RayHit> intersect(const std::array<glm::dvec3, 3>& c, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 a = c[0] - origin, b = c[1] - origin, d = c[2] - origin;
  const double u = glm::dot(direction, glm::cross(b, d));
  const double v = glm::dot(direction, glm::cross(d, a));
  const double w = glm::dot(direction, glm::cross(a, b));
  const double sum = u + v + w;
  if (sum == 0 || (std::min({u, v, w}) < 0 && std::max({u, v, w}) > 0)) return std::nullopt;
  RayHit hit;
  hit.barycentric = glm::dvec3(u, v, w) / sum;
  hit.edge = std::min({hit.barycentric.x, hit.barycentric.y, hit.barycentric.z});
  const glm::dvec3 point = hit.barycentric.x * a + hit.barycentric.y * b + hit.barycentric.z * d;
  hit.t = glm::dot(point, direction) / glm::dot(direction, direction);
  return hit;
}

}  // namespace

LightOracle::LightOracle(const scene::Scene& scene) : scene_(scene) {
  for (size_t t = 0; t < scene.triangleCount(); ++t) {
    std::array<glm::dvec3, 3> corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position);
    corners_.push_back(corners);
  }
}

glm::dvec3 LightOracle::corner(uint32_t triangle, int k) const { return corners_[triangle][static_cast<size_t>(k)]; }

glm::dvec3 LightOracle::normal(uint32_t triangle) const {
  const auto& c = corners_[triangle];
  return glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
}

std::optional<RayHit> LightOracle::castRay(const glm::dvec3& origin, const glm::dvec3& direction, double tMin) const {
  std::optional<RayHit> nearest;
  for (uint32_t i = 0; i < corners_.size(); ++i) {
    auto hit = intersect(corners_[i], origin, direction);
    if (!hit || hit->t <= tMin || (nearest && hit->t >= nearest->t)) continue;
    hit->triangle = i;
    nearest = hit;
  }
  return nearest;
}

bool LightOracle::isBlocked(const glm::dvec3& from, const glm::dvec3& to, double margin) const {
  return std::any_of(corners_.begin(), corners_.end(), [&](const auto& corners) {
    const auto hit = intersect(corners, from, to - from);
    return hit && hit->t > margin && hit->t < 1 - margin;
  });
}

bool LightOracle::isBlockedAlong(const glm::dvec3& from, const glm::dvec3& direction, double tMin) const {
  return std::any_of(corners_.begin(), corners_.end(), [&](const auto& corners) {
    const auto hit = intersect(corners, from, direction);
    return hit && hit->t > tMin;
  });
}

glm::dvec3 LightOracle::punctualIrradiance(const glm::dvec3& p, const glm::dvec3& n, const glm::dvec3& g, bool shadowed) const {
  glm::dvec3 sum(0);
  for (const scene::PunctualLight& light : scene_.lights) {
    const glm::dvec3 axis(light.direction), position(light.position);
    if (light.type == shared::kLightDirectional) {
      const double cosine = -glm::dot(n, axis);
      if (cosine <= 0 || glm::dot(g, axis) >= 0 || (shadowed && isBlockedAlong(p, -axis))) continue;
      sum += glm::dvec3(light.intensity) * cosine;
      continue;
    }
    const glm::dvec3 toLight = position - p;
    const double distance = glm::length(toLight);
    const double cosine = glm::dot(n, toLight) / distance;
    if (cosine <= 0 || glm::dot(g, toLight) <= 0) continue;
    double factor = cosine / (distance * distance);
    if (light.range > 0) factor *= std::max(std::min(1 - std::pow(distance / double{light.range}, 4.0), 1.0), 0.0);
    if (light.type == shared::kLightSpot) {
      // KHR_lights_punctual, "Inner and Outer Cone Angles".
      const double inner = std::cos(double{light.innerConeAngle}), outer = std::cos(double{light.outerConeAngle});
      const double angular = std::clamp((-glm::dot(toLight, axis) / distance - outer) / std::max(0.001, inner - outer), 0.0, 1.0);
      factor *= angular * angular;
    }
    if (factor <= 0 || (shadowed && isBlocked(p, position))) continue;
    sum += glm::dvec3(light.intensity) * factor;
  }
  return sum;
}

glm::dvec3 LightOracle::emitterIrradiance(const glm::dvec3& p, const glm::dvec3& n, const glm::dvec3& g, int level, bool shadowed) const {
  glm::dvec3 sum(0);
  const int pieces = 1 << level;
  for (uint32_t i = 0; i < corners_.size(); ++i) {
    const shared::Material& material = scene_.materials[scene_.triangleMaterials[i]];
    if ((material.flags & shared::kMaterialEmissive) == 0) continue;
    const auto& c = corners_[i];
    const glm::dvec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double area = 0.5 * glm::length(cross) / (pieces * pieces);
    const glm::dvec3 front = glm::normalize(cross);
    double factor = 0;
    for (int row = 0; row < pieces; ++row) {
      for (int column = 0; column < 2 * (pieces - row) - 1; ++column) {
        // Centre of an upright (even) or inverted (odd) piece of the barycentric grid.
        const double third = column % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
        const double b1 = (column / 2 + third) / pieces, b2 = (row + third) / pieces;
        const glm::dvec3 q = c[0] + b1 * (c[1] - c[0]) + b2 * (c[2] - c[0]);
        const glm::dvec3 d = q - p;
        const double d2 = glm::dot(d, d);
        const double receiver = glm::dot(n, d), emitter = -glm::dot(front, d);
        if (receiver <= 0 || emitter <= 0 || glm::dot(g, d) <= 0) continue;
        if (shadowed && isBlocked(p, q)) continue;
        factor += receiver * emitter / (d2 * d2) * area;
      }
    }
    sum += glm::dvec3(material.emission) * factor;
  }
  return sum;
}

void LightOracle::cameraRay(const scene::CameraDescription& camera, uint32_t width, uint32_t height, double x, double y, glm::dvec3& origin,
                            glm::dvec3& direction) {
  const glm::dquat orientation(camera.orientation);
  const double aspect = double{1} * width / height;
  const double right = (2 * x / width - 1) * aspect, up = 1 - 2 * y / height;
  if (camera.orthographic) {
    origin = glm::dvec3(camera.position) + orientation * glm::dvec3(right * double{camera.ymag}, up * double{camera.ymag}, 0);
    direction = orientation * glm::dvec3(0, 0, -1);
  } else {
    const double half = std::tan(0.5 * double{camera.yfov});
    origin = glm::dvec3(camera.position);
    direction = glm::normalize(orientation * glm::dvec3(right * half, up * half, -1));
  }
}

}  // namespace radivox::oracles
