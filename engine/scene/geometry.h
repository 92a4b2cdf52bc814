// World-space triangles while a scene is put together: what the importer and the built-in scenes share. Internal to engine/scene.
#pragma once

#include "engine/scene/scene.h"

namespace radivox::scene {

struct Assembly {
  std::vector<glm::dvec3> positions;     ///< world, m
  std::vector<shared::Vertex> vertices;  ///< one a position; Vertex::position is set by finishGeometry
  std::vector<uint32_t> indices;
  std::vector<uint32_t> triangleMaterials;
  std::vector<Object> objects;
};

/// Chooses Scene::origin, rounds positions to float, drops triangles without area (with a warning) and vertices that nothing uses.
/// Positions must be finite. Throws BadInput when the scene spans more than 1e9 m.
void finishGeometry(Assembly&& assembly, Scene& scene);

/// A view of the whole from above a corner of the bounds.
CameraDescription makeDefaultCamera(const Scene& scene);

/// Orientation that looks along `forward` with `up` as near to up as it goes.
glm::quat orientationFrom(const glm::dvec3& forward, const glm::dvec3& up);

/// Cross product of a triangle's edges in double: its length is twice the area.
glm::dvec3 areaVector(const Scene& scene, size_t triangle);

}  // namespace radivox::scene
