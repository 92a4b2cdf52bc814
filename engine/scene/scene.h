// A scene as Radivox lights it: flattened world-space triangles, Lambertian materials, lights, cameras, a sky.
// Positions are float metres relative to `origin` (double), so that a scene a million metres away keeps its precision.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <string>
#include <vector>

#include "engine/scene/traits.h"
#include "shaders/shared/scene.h"

namespace radivox::scene {

struct TextureImage {
  std::string name;
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;  ///< rows from the top, 4 bytes a texel
  uint32_t wrapU = shared::kWrapRepeat, wrapV = shared::kWrapRepeat;
  bool nearest = false;
  bool srgb = true;
};

struct PunctualLight {
  std::string name;
  uint32_t type = shared::kLightDirectional;  ///< kLightDirectional, kLightPoint, kLightSpot
  glm::vec3 position{0.f};                    ///< relative to origin
  glm::vec3 direction{0.f, -1.f, 0.f};        ///< unit, along which light travels
  glm::vec3 intensity{0.f};                   ///< W/m² (directional) or W/sr
  float range = 0.f;                          ///< 0: unlimited
  float innerConeAngle = 0.f, outerConeAngle = 0.785398f;
};

struct CameraDescription {
  std::string name;
  glm::vec3 position{0.f};                    ///< relative to origin
  glm::quat orientation{1.f, 0.f, 0.f, 0.f};  ///< looks along −z, y up
  bool orthographic = false;
  float yfov = 0.8f;    ///< radians
  float ymag = 1.f;     ///< orthographic half height, m
  float znear = 1e-3f;  ///< m, along the view axis
  float zfar = 1e3f;    ///< m; orthographic only (perspective ends nowhere)
};

/// What can be moved by itself: an instance of a mesh primitive. Its triangles use its own vertices and no others.
struct Object {
  std::string name;  ///< of the glTF node, or of its mesh; "node.1" for a second primitive
  uint32_t firstVertex = 0, vertexCount = 0;
};

struct Sky;  // engine/scene/sky.h

struct Scene {
  std::string name;
  glm::dvec3 origin{0.0};
  std::vector<shared::Vertex> vertices;
  std::vector<uint32_t> indices;            ///< 3 a triangle, < vertices.size()
  std::vector<uint32_t> triangleMaterials;  ///< one a triangle
  std::vector<Object> objects;              ///< in the order of their vertices; built-in scenes have none
  std::vector<shared::Material> materials;  ///< at least one
  std::vector<std::string> materialNames;
  std::vector<TextureImage> textures;
  std::vector<PunctualLight> lights;
  std::vector<CameraDescription> cameras;  ///< at least one (a default view of the bounds is made when the file has none)
  glm::vec3 skyRadiance{0.f};              ///< constant over the sphere, W/(m² sr); adds to `sky`
  std::shared_ptr<const Sky> sky;          ///< an image; null: none
  std::vector<std::string> warnings;       ///< one line each; what was left out of the file and why

  size_t triangleCount() const { return indices.size() / 3; }
  Traits traits() const;
};

/// SCENE of the command line: a .gltf/.glb path or builtin:NAME[?key=value&…]. Throws BadInput naming file, place and mend.
/// `sky`, where it is not empty, takes the place of the scene's own (loadSky in engine/scene/sky.h).
Scene loadScene(const std::string& scene, const std::string& sky = "");
/// Warning of importGltf.
constexpr const char* kNoLightWarning = "the scene has no light: no lights, no emissive surface, no sky";

/// Moves vertices [first, first + count) by an affine map of positions relative to Scene::origin; normals follow. GpuScene::setGeometry brings it to the
/// device. Throws BadInput where `by` mirrors, flattens or is not finite, and nothing is moved then.
void moveVertices(Scene& scene, uint32_t first, uint32_t count, const glm::mat4& by);

/// By name or index; throws BadInput with the names there are.
const CameraDescription& findCamera(const Scene& scene, const std::string& nameOrIndex);

/// Projection for an image of this size (reversed z, infinite far plane, y down in clip space as Vulkan has it).
shared::Camera makeCamera(const CameraDescription& camera, uint32_t width, uint32_t height);

}  // namespace radivox::scene
