#include "engine/scene/gltf_mesh.h"

#include <cmath>

namespace radivox::scene::gltf {

namespace {

// glTF primitive modes.
constexpr uint64_t kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;

/// World positions may be far away (Scene::origin takes care), but not absurdly so.
constexpr double kMaxWorldCoordinate = 1e15;

std::string printVec(const float* v) {
  return "(" + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " + std::to_string(v[2]) + ")";
}

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Transposed inverse without the division: right for any matrix of rank 2 or more, mirrors included.
glm::dmat3 normalMatrix(const glm::dmat3& m) {
  const glm::dmat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactor : cofactor;
}

}  // namespace

const std::vector<Primitive>& MeshReader::mesh(size_t index) {
  auto& cached = meshes_[index];
  if (cached) return *cached;
  cached.emplace();
  const Value json = document_.entry("meshes", index);
  const Value primitives = json.at("primitives");
  for (size_t i = 0; i < primitives.size(); ++i) {
    const Value primitive = primitives[i];
    const uint64_t mode = primitive.wholeOr("mode", kTriangles);
    if (mode < kTriangles) {
      warnings_.add("points and lines are left out");
      continue;
    }
    if (mode > kTriangleFan) primitive.at("mode").fail("is " + std::to_string(mode) + ", should be 0 to 6");
    if (primitive.has("targets")) warnings_.add("morph targets are left out, the base shape is used");
    cached->push_back(readPrimitive(primitive));
  }
  return *cached;
}

Primitive MeshReader::readPrimitive(const Value& json) {
  Primitive out;
  out.place = json.place();
  const size_t accessorCount = document_.count("accessors");
  const size_t materialCount = document_.count("materials");
  out.material = static_cast<uint32_t>(json.indexOr("material", materialCount, "materials").value_or(materialCount));
  const Value attributes = json.at("attributes");
  if (!attributes.has("POSITION")) {
    warnings_.add("primitives without POSITION are left out");
    return out;
  }
  const size_t positionAccessor = attributes.index("POSITION", accessorCount, "accessors");
  const FloatData positions = document_.readFloats(positionAccessor, "VEC3", attributes.at("POSITION"));
  const size_t vertexCount = positions.count();
  out.positions.resize(vertexCount);
  for (size_t i = 0; i < vertexCount; ++i) {
    const float* p = positions.values.data() + i * 3;
    out.positions[i] = {p[0], p[1], p[2]};
    if (isFinite(out.positions[i])) continue;
    attributes.at("POSITION")
        .fail("accessors[" + std::to_string(positionAccessor) + "]: vertex " + std::to_string(i) + " is not finite " + printVec(p) +
              "; repair the mesh and export it again");
  }
  if (const auto accessor = attributes.indexOr("NORMAL", accessorCount, "accessors")) {
    const FloatData normals = document_.readFloats(*accessor, "VEC3", attributes.at("NORMAL"));
    if (normals.count() != vertexCount) {
      attributes.at("NORMAL").fail("has " + std::to_string(normals.count()) + " entries, POSITION has " + std::to_string(vertexCount) +
                                   "; export the file again");
    }
    out.normals.resize(vertexCount);
    for (size_t i = 0; i < vertexCount; ++i) out.normals[i] = {normals.values[i * 3], normals.values[i * 3 + 1], normals.values[i * 3 + 2]};
  }
  out.indices = readTriangles(json, vertexCount);
  warnAboutColors(attributes);
  const MaterialCoordinates& wanted = coordinates_[out.material];
  if (wanted.base) out.uvBase = readCoordinates(attributes, *wanted.base, vertexCount);
  if (wanted.emissive) out.uvEmissive = readCoordinates(attributes, *wanted.emissive, vertexCount);
  return out;
}

std::vector<uint32_t> MeshReader::readTriangles(const Value& json, size_t vertexCount) {
  std::vector<uint32_t> order;
  if (const auto accessor = json.indexOr("indices", document_.count("accessors"), "accessors")) {
    order = document_.readIndices(*accessor, json.at("indices"));
    for (size_t i = 0; i < order.size(); ++i) {
      if (order[i] < vertexCount) continue;
      json.at("indices").fail("accessors[" + std::to_string(*accessor) + "]: index " + std::to_string(i) + " is " +
                              std::to_string(order[i]) + ", but POSITION has " + std::to_string(vertexCount) +
                              " vertices; export the file again");
    }
  } else {
    order.resize(vertexCount);
    for (size_t i = 0; i < vertexCount; ++i) order[i] = static_cast<uint32_t>(i);
  }
  const uint64_t mode = json.wholeOr("mode", kTriangles);
  if (mode == kTriangles) {
    if (order.size() % 3 != 0)
      warnings_.add(json.place() + " has " + std::to_string(order.size() % 3) + " indices too many for whole triangles, they are left out");
    order.resize(order.size() / 3 * 3);
    return order;
  }
  std::vector<uint32_t> triangles;
  for (size_t i = 0; i + 2 < order.size(); ++i) {
    uint32_t a = order[i], b = order[i + 1], c = order[i + 2];
    if (mode == kTriangleFan) {
      a = order[i + 1];
      b = order[i + 2];
      c = order[0];
    } else if (i % 2 == 1) {
      std::swap(b, c);
    }
    if (a == b || b == c || c == a) continue;  // stitches between strips: meant to vanish, so no warning
    triangles.insert(triangles.end(), {a, b, c});
  }
  return triangles;
}

std::vector<glm::vec2> MeshReader::readCoordinates(const Value& attributes, const TextureCoordinates& wanted, size_t vertexCount) {
  const std::string name = "TEXCOORD_" + std::to_string(wanted.set);
  const auto accessor = attributes.indexOr(name, document_.count("accessors"), "accessors");
  if (!accessor) {
    warnings_.add("textured primitives without " + name + ": their texture is read at one point");
    return {};
  }
  const FloatData data = document_.readFloats(*accessor, "VEC2", attributes.at(name));
  if (data.count() != vertexCount) {
    attributes.at(name).fail("has " + std::to_string(data.count()) + " entries, POSITION has " + std::to_string(vertexCount) +
                             "; export the file again");
  }
  std::vector<glm::vec2> out(vertexCount);
  uint64_t unusable = 0;
  for (size_t i = 0; i < vertexCount; ++i) {
    const double u = data.values[i * 2], v = data.values[i * 2 + 1];
    const glm::dvec2 uv(wanted.a * u + wanted.b * v + wanted.offsetU, wanted.c * u + wanted.d * v + wanted.offsetV);
    // Past 2^20 repeats a float holds no texel any more.
    if (std::abs(uv.x) < 1048576.0 && std::abs(uv.y) < 1048576.0)
      out[i] = glm::vec2(uv);
    else
      ++unusable;
  }
  if (unusable > 0) warnings_.add("texture coordinates that are not finite or beyond 2^20 are read as 0", unusable);
  return out;
}

void MeshReader::warnAboutColors(const Value& attributes) {
  const auto accessor = attributes.indexOr("COLOR_0", document_.count("accessors"), "accessors");
  if (!accessor) return;
  const FloatData colors = document_.readFloats(*accessor, "VEC3 VEC4", attributes.at("COLOR_0"));
  for (size_t i = 0; i < colors.values.size(); ++i) {
    if (i % colors.components == 3 || std::abs(colors.values[i] - 1.f) < 1e-3f) continue;
    warnings_.add("vertex colours are left out; put them into a texture");
    return;
  }
}

void appendInstance(const Primitive& primitive, const glm::dmat4& toWorld, const Value& node, Assembly& assembly, Warnings& warnings) {
  if (primitive.indices.empty()) return;
  const glm::dmat3 linear(toWorld);
  const bool mirrored = glm::determinant(linear) < 0;
  const size_t vertexCount = primitive.positions.size();
  std::vector<glm::dvec3> world(vertexCount);
  for (size_t i = 0; i < vertexCount; ++i) {
    world[i] = glm::dvec3(toWorld * glm::dvec4(glm::dvec3(primitive.positions[i]), 1.0));
    const glm::dvec3 magnitude = glm::abs(world[i]);
    if (magnitude.x <= kMaxWorldCoordinate && magnitude.y <= kMaxWorldCoordinate && magnitude.z <= kMaxWorldCoordinate) continue;
    node.fail("its transform moves vertex " + std::to_string(i) + " of " + primitive.place + " beyond 1e15 m; correct the transform");
  }
  std::vector<uint32_t> indices = primitive.indices;
  if (mirrored) {
    for (size_t i = 0; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
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
  assembly.triangleMaterials.insert(assembly.triangleMaterials.end(), indices.size() / 3, primitive.material);

  if (primitive.normals.empty()) {  // flat: every triangle its own three vertices
    for (size_t i = 0; i < indices.size(); ++i) {
      push(indices[i], unit(areaOf(i / 3)));
      assembly.indices.push_back(first + static_cast<uint32_t>(i));
    }
    return;
  }
  const glm::dmat3 toNormal = normalMatrix(linear);
  std::vector<glm::dvec3> normals(vertexCount);
  std::vector<bool> unusable(vertexCount, false);
  uint64_t unusableCount = 0;
  for (size_t i = 0; i < vertexCount; ++i) {
    const glm::dvec3 n = toNormal * glm::dvec3(primitive.normals[i]);
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
