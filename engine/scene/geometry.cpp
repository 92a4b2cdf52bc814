#include "engine/scene/geometry.h"

#include <algorithm>
#include <cmath>

#include "engine/error.h"

namespace radivox::scene {

namespace {

/// 0 for scenes near the world's origin, so that their numbers stay as they are; else the centre, rounded to a power of two near the
/// extent, so that no position is rounded twice.
glm::dvec3 chooseOrigin(const glm::dvec3& min, const glm::dvec3& max) {
  const glm::dvec3 centre = (min + max) * 0.5;
  const double extent = glm::length(max - min);
  if (!(glm::length(centre) > 1000.0 * extent) || !(extent > 0)) return glm::dvec3(0.0);
  const double step = std::exp2(std::floor(std::log2(extent)));
  return glm::round(centre / step) * step;
}

/// Edges longer than this make cross products whose squares overflow floats in shaders.
constexpr double kMaxExtent = 1e9;
/// Below this the square of a cross product is no normal float, and a shader could not normalise it.
constexpr double kMinDoubleArea = 2e-19;
/// A triangle this thin against its longest edge is rounding noise, its normal too.
constexpr double kMinThinness = 1e-9;

bool hasArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double doubleArea = glm::length(glm::cross(b - a, c - a));
  const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return doubleArea > kMinDoubleArea && doubleArea > kMinThinness * longest;
}

void dropUnusedVertices(Scene& scene) {
  std::vector<uint32_t> newIndex(scene.vertices.size(), 0u);
  for (const uint32_t i : scene.indices) newIndex[i] = 1u;
  uint32_t kept = 0;
  for (size_t i = 0; i < scene.vertices.size(); ++i) {
    if (newIndex[i] == 0u) continue;
    scene.vertices[kept] = scene.vertices[i];
    newIndex[i] = kept++;
  }
  if (kept == scene.vertices.size()) return;
  scene.vertices.resize(kept);
  for (uint32_t& i : scene.indices) i = newIndex[i];
}

/// What is left of each object once unused vertices are dropped; those without any are no more.
void countObjectVertices(std::vector<Object>& objects, const std::vector<uint32_t>& indices, size_t vertexCount) {
  std::vector<uint32_t> keptBefore(vertexCount + 1, 0u);
  for (const uint32_t i : indices) keptBefore[i + 1] = 1u;
  for (size_t i = 0; i < vertexCount; ++i) keptBefore[i + 1] += keptBefore[i];
  for (Object& object : objects) {
    const uint32_t first = keptBefore[object.firstVertex];
    object.vertexCount = keptBefore[object.firstVertex + object.vertexCount] - first;
    object.firstVertex = first;
  }
  std::erase_if(objects, [](const Object& object) { return object.vertexCount == 0; });
}

}  // namespace

void finishGeometry(Assembly&& assembly, Scene& scene) {
  glm::dvec3 min(std::numeric_limits<double>::max()), max(std::numeric_limits<double>::lowest());
  for (const uint32_t i : assembly.indices) {
    min = glm::min(min, assembly.positions[i]);
    max = glm::max(max, assembly.positions[i]);
  }
  if (!assembly.indices.empty() && glm::length(max - min) > kMaxExtent) {
    throw Error(ErrorCode::BadInput, scene.name + ": the scene spans " + std::to_string(glm::length(max - min)) +
                                         " m, at most 1e9 m can be lit; scale it down or remove what lies far away");
  }
  scene.origin = assembly.indices.empty() ? glm::dvec3(0.0) : chooseOrigin(min, max);
  scene.vertices = std::move(assembly.vertices);
  for (size_t i = 0; i < scene.vertices.size(); ++i) scene.vertices[i].position = glm::vec3(assembly.positions[i] - scene.origin);

  scene.indices.clear();
  scene.triangleMaterials.clear();
  scene.indices.reserve(assembly.indices.size());
  scene.triangleMaterials.reserve(assembly.triangleMaterials.size());
  uint64_t dropped = 0;
  for (size_t t = 0; t < assembly.triangleMaterials.size(); ++t) {
    const uint32_t* corner = assembly.indices.data() + t * 3;
    const auto at = [&](size_t k) { return glm::dvec3(scene.vertices[corner[k]].position); };
    if (!hasArea(at(0), at(1), at(2))) {
      ++dropped;
      continue;
    }
    scene.indices.insert(scene.indices.end(), corner, corner + 3);
    scene.triangleMaterials.push_back(assembly.triangleMaterials[t]);
  }
  if (dropped > 0) scene.warnings.push_back(std::to_string(dropped) + " triangles without area are left out");
  scene.objects = std::move(assembly.objects);
  countObjectVertices(scene.objects, scene.indices, scene.vertices.size());
  dropUnusedVertices(scene);
}

void moveVertices(Scene& scene, uint32_t first, uint32_t count, const glm::mat4& by) {
  if (size_t{first} + count > scene.vertices.size())
    throw Error(ErrorCode::BadInput, scene.name + ": vertices " + std::to_string(first) + " to " + std::to_string(size_t{first} + count) +
                                         " of " + std::to_string(scene.vertices.size()) + " cannot be moved");
  const glm::dmat4 affine(by);
  const glm::dmat3 linear(affine);
  const glm::dmat3 normals(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1]));
  const double volume = glm::dot(linear[0], normals[0]);
  if (!(volume > 0) || !std::isfinite(volume))
    throw Error(ErrorCode::BadInput,
                scene.name + ": a move must neither mirror nor flatten, and its determinant is " + std::to_string(volume));
  const auto isFine = [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  std::vector<shared::Vertex> moved(scene.vertices.begin() + first, scene.vertices.begin() + first + count);
  for (shared::Vertex& vertex : moved) {
    vertex.position = glm::vec3(affine * glm::dvec4(glm::dvec3(vertex.position), 1.0));
    const glm::dvec3 n = normals * glm::dvec3(vertex.normal);
    const double length = glm::length(n);
    if (length > 0) vertex.normal = glm::vec3(n / length);
    if (!isFine(vertex.position) || !isFine(vertex.normal))
      throw Error(ErrorCode::BadInput, scene.name + ": the move leads beyond what floats can hold");
  }
  std::copy(moved.begin(), moved.end(), scene.vertices.begin() + first);
}

glm::dvec3 areaVector(const Scene& scene, size_t triangle) {
  const auto at = [&](size_t k) { return glm::dvec3(scene.vertices[scene.indices[triangle * 3 + k]].position); };
  return glm::cross(at(1) - at(0), at(2) - at(0));
}

}  // namespace radivox::scene
