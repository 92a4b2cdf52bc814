// Instances of mesh primitives in world space: transforms, skins at rest, normals.
#include <cmath>

#include "engine/scene/gltf_mesh.h"

namespace radivox::scene::gltf {

namespace {

/// World positions may be far away (Scene::origin takes care), but not absurdly so.
constexpr double kMaxWorldCoordinate = 1e15;

/// Transposed inverse without the division: right for any matrix of rank 2 or more, mirrors included.
glm::dmat3 normalMatrix(const glm::dmat3& m) {
  const glm::dmat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactor : cofactor;
}

/// Each vertex's way to the world: one matrix for all, or one each.
std::vector<glm::dmat4> vertexTransforms(const Document& document, const Primitive& primitive, const glm::dmat4& toWorld,
                                         const std::vector<glm::dmat4>& joints) {
  if (joints.empty() || primitive.influences.empty()) return {toWorld};
  // Vertices that no joint moves stay where the node is.
  std::vector<glm::dmat4> out(primitive.positions.size(), toWorld);
  std::vector<bool> moved(out.size(), false);
  for (const SkinInfluence& influence : primitive.influences) {
    if (influence.joint >= joints.size()) {
      document.fail(primitive.place + ".attributes.JOINTS_0", "vertex " + std::to_string(influence.vertex) + " follows joint " +
                                                                  std::to_string(influence.joint) + ", but the skin has " +
                                                                  std::to_string(joints.size()) + "; export the file again");
    }
    glm::dmat4& matrix = out[influence.vertex];
    if (!moved[influence.vertex]) matrix = glm::dmat4(0.0);
    moved[influence.vertex] = true;
    matrix += joints[influence.joint] * influence.weight;
  }
  return out;
}

}  // namespace

void appendInstance(const Document& document, const Primitive& primitive, const glm::dmat4& toWorld, const std::vector<glm::dmat4>& joints,
                    const std::string& place, const std::string& name, Assembly& assembly, Warnings& warnings) {
  if (primitive.indices.empty()) return;
  const std::vector<glm::dmat4> transforms = vertexTransforms(document, primitive, toWorld, joints);
  const auto transformOf = [&](size_t vertex) -> const glm::dmat4& { return transforms[transforms.size() == 1 ? 0 : vertex]; };
  const size_t vertexCount = primitive.positions.size();
  std::vector<glm::dvec3> world(vertexCount);
  for (size_t i = 0; i < vertexCount; ++i) {
    world[i] = glm::dvec3(transformOf(i) * glm::dvec4(glm::dvec3(primitive.positions[i]), 1.0));
    const glm::dvec3 magnitude = glm::abs(world[i]);
    if (magnitude.x <= kMaxWorldCoordinate && magnitude.y <= kMaxWorldCoordinate && magnitude.z <= kMaxWorldCoordinate) continue;
    document.fail(place,
                  "its transform moves vertex " + std::to_string(i) + " of " + primitive.place + " beyond 1e15 m; correct the transform");
  }
  std::vector<uint32_t> indices = primitive.indices;
  for (size_t i = 0; i < indices.size(); i += 3) {
    if (glm::determinant(glm::dmat3(transformOf(indices[i]))) < 0) std::swap(indices[i + 1], indices[i + 2]);
  }
  const auto areaOf = [&](size_t triangle) {
    const uint32_t* c = indices.data() + triangle * 3;
    return glm::cross(world[c[1]] - world[c[0]], world[c[2]] - world[c[0]]);
  };
  const auto push = [&](size_t i, const glm::dvec3& normal) {
    shared::Vertex vertex{};
    vertex.normal = glm::vec3(normal);
    if (!primitive.uvBase.empty()) vertex.uvBase = primitive.uvBase[i];
    if (!primitive.uvEmissive.empty()) vertex.uvEmissive = primitive.uvEmissive[i];
    assembly.positions.push_back(world[i]);
    assembly.vertices.push_back(vertex);
  };
  const auto unit = [](const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0, 1, 0);
  };
  const auto first = static_cast<uint32_t>(assembly.positions.size());
  const auto vertices = static_cast<uint32_t>(primitive.normals.empty() ? indices.size() : vertexCount);
  assembly.objects.push_back({name, first, vertices});
  assembly.triangleMaterials.insert(assembly.triangleMaterials.end(), primitive.materials.begin(), primitive.materials.end());

  if (primitive.normals.empty()) {  // flat: every triangle its own three vertices
    for (size_t i = 0; i < indices.size(); ++i) {
      push(indices[i], unit(areaOf(i / 3)));
      assembly.indices.push_back(first + static_cast<uint32_t>(i));
    }
    return;
  }
  std::vector<glm::dvec3> normals(vertexCount);
  std::vector<bool> unusable(vertexCount, false);
  uint64_t unusableCount = 0;
  for (size_t i = 0; i < vertexCount; ++i) {
    const glm::dvec3 n = normalMatrix(glm::dmat3(transformOf(i))) * glm::dvec3(primitive.normals[i]);
    const double length = glm::length(n), before = glm::length(glm::dvec3(primitive.normals[i]));
    if (before > 1e-6 && std::isfinite(length) && length > 0) {
      normals[i] = n / length;
    } else {
      normals[i] = glm::dvec3(0.0);
      unusable[i] = true;
      ++unusableCount;
    }
  }
  if (unusableCount > 0) {
    warnings.add("normals that are zero or not finite are replaced by the geometric normal", unusableCount);
    // Area-weighted mean of the triangles around; one of them where they cancel.
    std::vector<glm::dvec3> any(vertexCount, glm::dvec3(0.0));
    for (size_t t = 0; t < indices.size() / 3; ++t) {
      const glm::dvec3 area = areaOf(t);
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t i = indices[t * 3 + k];
        if (!unusable[i]) continue;
        normals[i] += area;
        if (any[i] == glm::dvec3(0.0)) any[i] = area;
      }
    }
    for (size_t i = 0; i < vertexCount; ++i) {
      if (unusable[i]) normals[i] = unit(glm::length(normals[i]) > 1e-6 * glm::length(any[i]) ? normals[i] : any[i]);
    }
  }
  for (size_t i = 0; i < vertexCount; ++i) push(i, normals[i]);
  for (const uint32_t i : indices) assembly.indices.push_back(first + i);
}

}  // namespace radivox::scene::gltf
