// Which scene a name means, and what a scene contains.
#include "engine/scene/scene.h"

#include <algorithm>
#include <filesystem>

#include "engine/error.h"
#include "engine/scene/builtin.h"
#include "engine/scene/geometry.h"
#include "engine/scene/gltf.h"
#include "engine/scene/sky.h"

namespace radivox::scene {

namespace {

Scene loadBuiltin(const std::string& text) {
  const size_t question = text.find('?');
  const std::string name = text.substr(0, question);
  std::map<std::string, std::string> parameters;
  size_t at = question == std::string::npos ? text.size() : question + 1;
  while (at < text.size()) {
    const size_t end = std::min(text.find('&', at), text.size());
    const std::string pair = text.substr(at, end - at);
    const size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(ErrorCode::BadInput, "builtin:" + text + ": \"" + pair + "\" is no parameter; write builtin:NAME?key=value&key=value");
    }
    if (!parameters.emplace(pair.substr(0, equals), pair.substr(equals + 1)).second) {
      throw Error(ErrorCode::BadInput, "builtin:" + text + ": " + pair.substr(0, equals) + " is given twice; leave one out");
    }
    at = end + 1;
  }
  return makeBuiltin(name, parameters);
}

}  // namespace

namespace {

Scene loadWithItsSky(const std::string& scene) {
  constexpr std::string_view kPrefix = "builtin:";
  if (scene.rfind(kPrefix, 0) == 0) return loadBuiltin(scene.substr(kPrefix.size()));
  if (scene.empty()) throw Error(ErrorCode::BadInput, "no scene is named; give a .gltf or .glb file, or builtin:atrium");
  std::error_code ignored;
  if (!std::filesystem::exists(scene, ignored)) {
    const std::string name = scene.substr(0, scene.find('?'));
    for (const auto& builtin : builtinScenes()) {
      if (builtin.name == name)
        throw Error(ErrorCode::BadInput, scene + ": no such file; write builtin:" + scene + " for the built-in scene");
    }
  }
  return importGltf(scene);
}

}  // namespace

Scene loadScene(const std::string& name, const std::string& sky) {
  Scene scene = loadWithItsSky(name);
  if (sky.empty()) return scene;
  scene.skyRadiance = glm::vec3(0.f);
  scene.sky = loadSky(sky);
  std::erase(scene.warnings, kNoLightWarning);
  scene.warnings.insert(scene.warnings.end(), scene.sky->notes.begin(), scene.sky->notes.end());
  return scene;
}

Traits Scene::traits() const {
  Traits t;
  t.triangleCount = triangleCount();
  t.vertexCount = vertices.size();
  t.materialCount = static_cast<uint32_t>(materials.size());
  t.textureCount = static_cast<uint32_t>(textures.size());
  const auto count = [&t](const PunctualLight& light) {
    if (light.type == shared::kLightDirectional) ++t.directionalLightCount;
    if (light.type == shared::kLightPoint) ++t.pointLightCount;
    if (light.type == shared::kLightSpot) ++t.spotLightCount;
  };
  std::for_each(lights.begin(), lights.end(), count);
  if (sky) std::for_each(sky->suns.begin(), sky->suns.end(), count);
  for (const auto& material : materials) {
    if ((material.flags & shared::kMaterialAlphaMask) != 0u) t.alphaMasked = true;
    if ((material.flags & shared::kMaterialDoubleSided) == 0u) t.singleSided = true;
  }
  t.origin = origin;
  t.reflects = false;
  for (const uint32_t m : triangleMaterials) {
    if (materials[m].albedo != glm::vec3(0.f)) t.reflects = true;
    if (t.reflects) break;
  }
  t.skyImage = sky != nullptr;
  t.sky = skyRadiance != glm::vec3(0.f) || t.skyImage;
  if (!indices.empty()) {
    t.boundsMin = t.boundsMax = vertices[indices[0]].position;
    for (const uint32_t i : indices) {
      t.boundsMin = glm::min(t.boundsMin, vertices[i].position);
      t.boundsMax = glm::max(t.boundsMax, vertices[i].position);
    }
  }
  for (size_t i = 0; i < triangleMaterials.size(); ++i) {
    const double area = glm::length(areaVector(*this, i)) * 0.5;
    t.surfaceArea += area;
    for (size_t k = 0; area > 0 && k < 3; ++k) {
      const glm::dvec3 from(vertices[indices[3 * i + k]].position), to(vertices[indices[3 * i + (k + 1) % 3]].position);
      const double edge = glm::distance(from, to);
      if (t.shortestEdge == 0 || edge < t.shortestEdge) t.shortestEdge = edge;
    }
    if ((materials[triangleMaterials[i]].flags & shared::kMaterialEmissive) == 0u) continue;
    t.emissiveArea += area;
    ++t.emissiveTriangleCount;
  }
  t.emittersByRays = t.emissiveTriangleCount > 0 && t.emissiveArea > kMaxSampledEmissiveShare * t.surfaceArea;
  return t;
}

}  // namespace radivox::scene
