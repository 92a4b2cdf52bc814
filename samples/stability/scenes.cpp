#include "samples/stability/scenes.h"

#include <glm/gtc/quaternion.hpp>

namespace radivox::stability {

SceneMaker::SceneMaker(std::string name) { scene_.name = std::move(name); }

uint32_t SceneMaker::addMaterial(float albedo, float emission) {
  shared::Material material{};
  material.albedo = glm::vec3(albedo);
  material.alpha = 1.f;
  material.emission = glm::vec3(emission);
  material.alphaCutoff = 0.5f;
  material.baseTexture = material.emissiveTexture = shared::kNoTexture;
  material.flags = emission > 0.f ? shared::kMaterialEmissive : 0u;
  scene_.materials.push_back(material);
  scene_.materialNames.push_back("material " + std::to_string(scene_.materials.size()));
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

void SceneMaker::addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, uint32_t material) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const glm::dvec3 normal = glm::length(cross) > 0 ? glm::normalize(cross) : glm::dvec3(0, 1, 0);
  for (const glm::dvec3& p : {a, b, c}) {
    scene_.indices.push_back(static_cast<uint32_t>(scene_.vertices.size()));
    shared::Vertex vertex{};
    vertex.position = glm::vec3(p);
    vertex.normal = glm::vec3(normal);
    scene_.vertices.push_back(vertex);
  }
  scene_.triangleMaterials.push_back(material);
}

void SceneMaker::addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d, uint32_t material) {
  addTriangle(a, b, c, material);
  addTriangle(a, c, d, material);
}

void SceneMaker::addPatch(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, uint32_t columns, uint32_t rows,
                          uint32_t material) {
  const auto at = [&](uint32_t i, uint32_t j) { return corner + u * (double{1} * i / columns) + v * (double{1} * j / rows); };
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) addQuad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), material);
  }
}

void SceneMaker::addBox(const glm::dvec3& low, const glm::dvec3& high, uint32_t material, uint32_t parts, bool inward) {
  const glm::dvec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  const glm::dvec3 edges[3][2] = {{x, y}, {y, z}, {z, x}};
  const glm::dvec3 across[3] = {z, x, y};
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 u = edges[k][0], v = edges[k][1];
    // u × v points along +across: into the box at its low side.
    addPatch(low, inward ? u : v, inward ? v : u, parts, parts, material);
    addPatch(low + across[k], inward ? v : u, inward ? u : v, parts, parts, material);
  }
}

void SceneMaker::addRoom(const glm::dvec3& low, const glm::dvec3& high, uint32_t material, uint32_t parts) {
  addBox(low, high, material, parts, true);
}

void SceneMaker::addBlock(const glm::dvec3& low, const glm::dvec3& high, uint32_t material) { addBox(low, high, material, 1, false); }

void SceneMaker::addLamp(const glm::dvec3& position, float intensity) {
  scene::PunctualLight light;
  light.name = "lamp";
  light.type = shared::kLightPoint;
  light.position = glm::vec3(position);
  light.intensity = glm::vec3(intensity);
  scene_.lights.push_back(light);
}

void SceneMaker::addSun(const glm::dvec3& direction, float irradiance) {
  scene::PunctualLight light;
  light.name = "sun";
  light.direction = glm::vec3(glm::normalize(direction));
  light.intensity = glm::vec3(irradiance);
  scene_.lights.push_back(light);
}

scene::CameraDescription makeCameraAt(const glm::dvec3& position, const glm::dvec3& target, float yfov) {
  scene::CameraDescription camera;
  camera.name = "view";
  camera.position = glm::vec3(position);
  const glm::dvec3 forward = glm::normalize(target - position);
  const glm::dvec3 up = std::abs(forward.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  camera.orientation = glm::quat(glm::quatLookAt(forward, up));
  camera.yfov = yfov;
  return camera;
}

void SceneMaker::lookFrom(const glm::dvec3& position, const glm::dvec3& target, float yfov) {
  scene_.cameras.push_back(makeCameraAt(position, target, yfov));
}

scene::Scene litRoom(float albedo) {
  SceneMaker make("room");
  const uint32_t wall = make.addMaterial(albedo);
  make.addRoom(glm::dvec3(-1), glm::dvec3(1), wall);
  make.addBlock({-0.7, -1, -0.6}, {-0.1, -0.1, 0}, wall);
  make.addLamp({0.3, 0.6, 0.2}, 1.f);
  make.lookFrom({0.5, 0.2, 0.9}, {-0.3, -0.4, -0.8}, 1.2f);
  return make.take();
}

}  // namespace radivox::stability
