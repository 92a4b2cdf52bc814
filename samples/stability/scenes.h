// Scenes of the stability cases that no built-in scene is.
#pragma once

#include <glm/glm.hpp>

#include "engine/scene/scene.h"

namespace radivox::stability {

/// Triangles one by one, with flat normals, exactly as given: nothing is dropped, clamped or moved.
class SceneMaker {
 public:
  explicit SceneMaker(std::string name);
  uint32_t addMaterial(float albedo, float emission = 0.f);
  /// Fronts are counter-clockwise.
  void addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, uint32_t material);
  void addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d, uint32_t material);
  /// columns × rows pieces of a parallelogram at `corner`; the front is where u × v points.
  void addPatch(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, uint32_t columns, uint32_t rows, uint32_t material);
  /// The inner (or outer) sides of a box.
  void addRoom(const glm::dvec3& low, const glm::dvec3& high, uint32_t material, uint32_t parts = 1);
  void addBlock(const glm::dvec3& low, const glm::dvec3& high, uint32_t material);
  void addLamp(const glm::dvec3& position, float intensity);
  void addSun(const glm::dvec3& direction, float irradiance);
  void lookFrom(const glm::dvec3& position, const glm::dvec3& target, float yfov = 1.f);
  scene::Scene take() { return std::move(scene_); }

 private:
  void addBox(const glm::dvec3& low, const glm::dvec3& high, uint32_t material, uint32_t parts, bool inward);
  scene::Scene scene_;
};

/// A room of 2 m with a lamp and a block in it: what most extreme cases begin with.
scene::Scene litRoom(float albedo = 0.6f);
scene::CameraDescription makeCameraAt(const glm::dvec3& position, const glm::dvec3& target, float yfov = 1.f);

}  // namespace radivox::stability
