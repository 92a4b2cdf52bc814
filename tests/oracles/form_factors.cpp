#include "tests/oracles/form_factors.h"

#include <cmath>
#include <numbers>

namespace radivox::oracles {

double pointToPolygon(const glm::dvec3& p, const glm::dvec3& n, const std::vector<glm::dvec3>& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % corners.size()] - p);
    const glm::dvec3 axis = glm::cross(a, b);
    const double sine = glm::length(axis);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(axis / sine, n);
  }
  return std::abs(sum) / (2 * std::numbers::pi);
}

double parallelSquares(double side, double distance) {
  const double x = side / distance, x2 = x * x, root = std::sqrt(1 + x2);
  return 2 / (std::numbers::pi * x2) *
         (std::log(std::sqrt((1 + x2) * (1 + x2) / (1 + 2 * x2))) + 2 * x * root * std::atan(x / root) - 2 * x * std::atan(x));
}

}  // namespace radivox::oracles
