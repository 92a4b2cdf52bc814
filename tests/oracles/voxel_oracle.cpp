#include "tests/oracles/voxel_oracle.h"

#include <algorithm>
#include <cmath>

namespace radivox::oracle {

namespace {

bool separates(const glm::dvec3& axis, const Corners& relative, double half) {
  const double a = glm::dot(axis, relative[0]), b = glm::dot(axis, relative[1]), c = glm::dot(axis, relative[2]);
  const double radius = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
  return std::min({a, b, c}) > radius || std::max({a, b, c}) < -radius;
}

}  // namespace

bool overlapsCube(const Corners& triangle, const glm::dvec3& centre, double half) {
  const Corners relative{triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
  const glm::dvec3 edges[3] = {relative[1] - relative[0], relative[2] - relative[1], relative[0] - relative[2]};
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 unit(0.0);
    unit[k] = 1.0;
    if (separates(unit, relative, half)) return false;
    for (const glm::dvec3& edge : edges)
      if (separates(glm::cross(unit, edge), relative, half)) return false;
  }
  return !separates(glm::cross(edges[0], edges[1]), relative, half);
}

std::vector<glm::dvec3> clipByPlane(const std::vector<glm::dvec3>& polygon, int axis, double plane, double sign) {
  std::vector<glm::dvec3> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3& a = polygon[i];
    const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a[axis] - plane), db = sign * (b[axis] - plane);
    if (da >= 0) kept.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      glm::dvec3 cut = a + (b - a) * (da / (da - db));
      cut[axis] = plane;
      kept.push_back(cut);
    }
  }
  return kept;
}

std::vector<glm::dvec3> clipToVoxel(const Corners& triangle, const glm::dvec3& low) {
  std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end());
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    polygon = clipByPlane(polygon, k, low[k], 1.0);
    polygon = clipByPlane(polygon, k, low[k] + 1.0, -1.0);
  }
  if (polygon.size() < 3) polygon.clear();
  return polygon;
}

bool ownsPlane(const Corners& triangle, const glm::dvec3& low) {
  for (int k = 0; k < 3; ++k) {
    const double upper = low[k] + 1.0;
    if (triangle[0][k] == upper && triangle[1][k] == upper && triangle[2][k] == upper) return false;
  }
  return true;
}

double areaOf(const std::vector<glm::dvec3>& polygon) {
  glm::dvec3 sum(0.0);
  for (size_t i = 2; i < polygon.size(); ++i) sum += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * glm::length(sum);
}

glm::dvec3 centroidOf(const std::vector<glm::dvec3>& polygon) {
  glm::dvec3 weighted(0.0), mean(0.0);
  double total = 0.0;
  for (const glm::dvec3& p : polygon) mean += p / static_cast<double>(polygon.size());
  for (size_t i = 2; i < polygon.size(); ++i) {
    const double area = glm::length(glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
    weighted += area * (polygon[0] + polygon[i - 1] + polygon[i]) / 3.0;
    total += area;
  }
  return total > 0.0 ? weighted / total : mean;
}

glm::dvec3 barycentricOf(const Corners& triangle, const glm::dvec3& point) {
  const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const double squared = glm::dot(normal, normal);
  if (!(squared > 0.0)) return glm::dvec3(1.0 / 3.0);
  const double b = glm::dot(glm::cross(triangle[2] - point, triangle[0] - point), normal) / squared;
  const double c = glm::dot(glm::cross(triangle[0] - point, triangle[1] - point), normal) / squared;
  return {1.0 - b - c, b, c};
}

}  // namespace radivox::oracle
