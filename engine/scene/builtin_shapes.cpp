// Built-in scenes of one shape.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin_mesh.h"

namespace radivox::scene {

namespace {

uint32_t addGrey(MeshBuilder& mesh, BuiltinParameters& parameters) {
  return mesh.addMaterial("grey", glm::vec3(static_cast<float>(parameters.number("albedo", 0.5, 0, 0.999))));
}

}  // namespace

void addBall(MeshBuilder& mesh, const glm::dvec3& centre, const std::function<double(const glm::dvec3& direction)>& radius, uint32_t cells,
             bool inward, uint32_t material) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const auto point = [&](double u, double v) {
        if ((sign < 0) != inward) std::swap(u, v);  // keeps fronts outside (or inside)
        glm::dvec3 p;
        p[axis] = sign;
        // The tangent evens the cells out.
        p[(axis + 1) % 3] = std::tan((2 * u - 1) * glm::quarter_pi<double>());
        p[(axis + 2) % 3] = std::tan((2 * v - 1) * glm::quarter_pi<double>());
        // tan(π/4) is not quite 1, and faces must meet exactly.
        for (int k = 0; k < 3; ++k) {
          if (std::abs(std::abs(p[k]) - 1.0) < 1e-12) p[k] = p[k] < 0 ? -1.0 : 1.0;
        }
        const glm::dvec3 direction = p / glm::length(p);
        return centre + direction * radius(direction);
      };
      mesh.addSurface(point, cells, cells, material, true);
    }
  }
}

void buildPlane(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double half = parameters.number("size", 10, 1e-3, 1e6) / 2;
  const uint32_t parts = parameters.whole("subdivisions", 1, 1, 1024);
  mesh.addSurface([&](double u, double v) { return glm::dvec3(half * (2 * u - 1), 0, half * (1 - 2 * v)); }, parts, parts,
                  addGrey(mesh, parameters), true);
  mesh.addSun({0, -1, 0}, glm::vec3(1.f));
  mesh.addCamera("above", {0, half * 1.2, half * 1.6}, {0, 0, 0}, 0.8);
}

void buildSphere(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double radius = parameters.number("radius", 1, 1e-3, 1e6);
  const uint32_t rings = parameters.whole("rings", 32, 3, 1024);
  const bool inward = parameters.whole("inward", 0, 0, 1) == 1;
  const uint32_t material = addGrey(mesh, parameters);
  addBall(
      mesh, glm::dvec3(0.0), [&](const glm::dvec3&) { return radius; }, rings, inward, material);
  if (inward) {
    mesh.addPointLight({0, 0, 0}, glm::vec3(static_cast<float>(radius * radius)));
    mesh.addCamera("inside", {0, 0, radius * 0.8}, {0, 0, 0}, 1.2);
  } else {
    mesh.addSun({-0.5, -1, -0.7}, glm::vec3(1.f));
    mesh.addCamera("front", {0, radius * 0.8, radius * 4}, {0, 0, 0}, 0.7);
  }
}

void buildRamp(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double angle = glm::radians(parameters.number("angle", 20, -80, 80));
  const double c = std::cos(angle), s = std::sin(angle);
  const auto point = [&](double u, double v) {
    const glm::dvec3 p(4 * u - 2, 0, 2 - 4 * v);
    const glm::dvec3 q(p.x * c, p.x * s, p.z);                     // about z
    return glm::dvec3(q.x, q.y * c - q.z * s, q.y * s + q.z * c);  // about x
  };
  mesh.addSurface(point, 1, 1, addGrey(mesh, parameters), true);
  mesh.addSun({0, -1, 0}, glm::vec3(1.f));
  mesh.addCamera("above", {0.5, 4, 5}, {0, 0, 0}, 0.8);
}

void buildStaircase(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const uint32_t steps = parameters.whole("steps", 10, 1, 500);
  const uint32_t material = addGrey(mesh, parameters);
  constexpr double kRise = 0.17, kRun = 0.29, kWidth = 1.5;
  const auto xs = evenly(0, kRun * steps, steps), ys = evenly(0, kRise * steps, steps);
  const auto isAir = [&](const glm::dvec3& centre) { return centre.y / kRise > std::ceil(centre.x / kRun); };
  mesh.addCellBoundary(xs, ys, {0, kWidth}, false, isAir, [&](const glm::dvec3&, const glm::dvec3&) { return material; });
  mesh.addSun({0.5, -1, -0.3}, glm::vec3(3.f));
  const double length = kRun * steps, height = kRise * steps;
  mesh.addCamera("front", {-0.6 * length - 1.0, height + 1.0, kWidth + 1.5}, {length * 0.5, height * 0.4, kWidth / 2}, 0.8);
}

}  // namespace radivox::scene
