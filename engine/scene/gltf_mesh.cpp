#include "engine/scene/gltf_mesh.h"

#include <algorithm>
#include <cmath>

namespace radivox::scene::gltf {

namespace {

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string printVec(const glm::vec3& v) {
  return "(" + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " + std::to_string(v[2]) + ")";
}

int attributeOf(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

}  // namespace

const std::vector<Primitive>& MeshReader::mesh(const tinygltf::Node& node) {
  const auto index = static_cast<size_t>(node.mesh);
  const tinygltf::Mesh& source = document_.model().meshes[index];
  const std::vector<double>& weights = node.weights.empty() ? source.weights : node.weights;
  const auto [known, isNew] = meshes_.try_emplace({node.mesh, weights});
  if (!isNew) return known->second;
  for (size_t i = 0; i < source.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = source.primitives[i];
    const std::string place = placeOf("meshes", index) + placeOf(".primitives", i);
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      warnings_.add("points and lines are left out");
      continue;
    }
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
      document_.fail(place + ".mode", "is " + std::to_string(primitive.mode) + ", should be 0 to 6");
    known->second.push_back(readPrimitive(primitive, weights, place));
  }
  return known->second;
}

Primitive MeshReader::readPrimitive(const tinygltf::Primitive& source, const std::vector<double>& weights, const std::string& place) {
  Primitive out;
  out.place = place;
  const auto material =
      static_cast<uint32_t>(source.material < 0 ? document_.model().materials.size() : static_cast<size_t>(source.material));
  const int positions = attributeOf(source.attributes, "POSITION");
  if (positions < 0) {
    warnings_.add("primitives without POSITION are left out");
    return out;
  }
  const std::string attributes = place + ".attributes";
  const size_t vertexCount = document_.model().accessors[static_cast<size_t>(positions)].count;
  out.positions = readVectors(source, "POSITION", vertexCount, attributes);
  out.normals = readVectors(source, "NORMAL", vertexCount, attributes);
  addMorphTargets(source, weights, out);
  for (size_t i = 0; i < vertexCount; ++i) {
    if (isFinite(out.positions[i])) continue;
    document_.fail(attributes + ".POSITION", placeOf("accessors", static_cast<size_t>(positions)) + ": vertex " + std::to_string(i) +
                                                 " is not finite " + printVec(out.positions[i]) + "; repair the mesh and export it again");
  }
  out.indices = readTriangles(source, vertexCount, place);
  out.materials.assign(out.indices.size() / 3, material);
  applyColors(source, material, out);
  readInfluences(source, out);
  const MaterialCoordinates& wanted = coordinates_[material];
  if (wanted.base) out.uvBase = readCoordinates(source, *wanted.base, vertexCount, attributes);
  if (wanted.emissive) out.uvEmissive = readCoordinates(source, *wanted.emissive, vertexCount, attributes);
  return out;
}

/// Empty when the primitive has no such attribute; else one element a vertex.
FloatData MeshReader::readAttribute(const tinygltf::Primitive& source, const std::string& name, std::string_view types, size_t vertexCount,
                                    const std::string& place) {
  const int accessor = attributeOf(source.attributes, name);
  if (accessor < 0) return {};
  FloatData data = document_.readFloats(accessor, types, place + "." + name);
  if (data.count() != vertexCount) {
    document_.fail(place + "." + name, "has " + std::to_string(data.count()) + " entries, POSITION has " + std::to_string(vertexCount) +
                                           "; export the file again");
  }
  return data;
}

std::vector<glm::vec3> MeshReader::readVectors(const tinygltf::Primitive& source, const char* name, size_t vertexCount,
                                               const std::string& place) {
  const FloatData data = readAttribute(source, name, "VEC3", vertexCount, place);
  std::vector<glm::vec3> out(data.count());
  for (size_t i = 0; i < out.size(); ++i) out[i] = {data.values[i * 3], data.values[i * 3 + 1], data.values[i * 3 + 2]};
  return out;
}

/// Base shape + Σ weight · target.
void MeshReader::addMorphTargets(const tinygltf::Primitive& source, const std::vector<double>& weights, Primitive& out) {
  for (size_t t = 0; t < std::min(source.targets.size(), weights.size()); ++t) {
    if (weights[t] == 0) continue;
    const auto weight = static_cast<float>(weights[t]);
    tinygltf::Primitive target;
    target.attributes = source.targets[t];
    const std::string place = out.place + placeOf(".targets", t);
    const auto add = [&](const char* name, std::vector<glm::vec3>& to) {
      if (to.empty()) return;
      const std::vector<glm::vec3> offsets = readVectors(target, name, to.size(), place);
      for (size_t i = 0; i < offsets.size(); ++i) to[i] += weight * offsets[i];
    };
    add("POSITION", out.positions);
    add("NORMAL", out.normals);
  }
}

std::vector<uint32_t> MeshReader::readTriangles(const tinygltf::Primitive& source, size_t vertexCount, const std::string& place) {
  std::vector<uint32_t> order;
  if (source.indices >= 0) {
    order = document_.readIndices(source.indices, place + ".indices");
    for (size_t i = 0; i < order.size(); ++i) {
      if (order[i] < vertexCount) continue;
      document_.fail(place + ".indices", placeOf("accessors", static_cast<size_t>(source.indices)) + ": index " + std::to_string(i) +
                                             " is " + std::to_string(order[i]) + ", but POSITION has " + std::to_string(vertexCount) +
                                             " vertices; export the file again");
    }
  } else {
    order.resize(vertexCount);
    for (size_t i = 0; i < vertexCount; ++i) order[i] = static_cast<uint32_t>(i);
  }
  if (source.mode == TINYGLTF_MODE_TRIANGLES) {
    if (order.size() % 3 != 0)
      warnings_.add(place + " has " + std::to_string(order.size() % 3) + " indices too many for whole triangles, they are left out");
    order.resize(order.size() / 3 * 3);
    return order;
  }
  std::vector<uint32_t> triangles;
  for (size_t i = 0; i + 2 < order.size(); ++i) {
    uint32_t a = order[i], b = order[i + 1], c = order[i + 2];
    if (source.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
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

std::vector<glm::vec2> MeshReader::readCoordinates(const tinygltf::Primitive& source, const TextureCoordinates& wanted, size_t vertexCount,
                                                   const std::string& place) {
  const std::string name = "TEXCOORD_" + std::to_string(wanted.set);
  const FloatData data = readAttribute(source, name, "VEC2", vertexCount, place);
  if (data.components == 0) {
    warnings_.add("textured primitives without " + name + ": their texture is read at one point");
    return {};
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

void MeshReader::readInfluences(const tinygltf::Primitive& source, Primitive& out) {
  const size_t vertexCount = out.positions.size();
  const std::string place = out.place + ".attributes";
  for (int set = 0; attributeOf(source.attributes, "JOINTS_" + std::to_string(set)) >= 0; ++set) {
    const std::string number = std::to_string(set);
    const FloatData joints = readAttribute(source, "JOINTS_" + number, "VEC4", vertexCount, place);
    const FloatData weights = readAttribute(source, "WEIGHTS_" + number, "VEC4", vertexCount, place);
    for (size_t i = 0; i < weights.values.size(); ++i) {
      const float joint = joints.values[i], weight = weights.values[i];
      if (!(weight > 0) || !std::isfinite(weight)) continue;
      if (!(joint >= 0 && joint < 65536))
        document_.fail(place + ".JOINTS_" + number, "names joint " + std::to_string(joint) + "; export the file again");
      out.influences.push_back({static_cast<uint32_t>(i / 4), static_cast<uint32_t>(joint), weight});
    }
  }
  std::stable_sort(out.influences.begin(), out.influences.end(), [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
  for (size_t first = 0, end = 0; first < out.influences.size(); first = end) {
    double sum = 0;
    for (end = first; end < out.influences.size() && out.influences[end].vertex == out.influences[first].vertex; ++end)
      sum += out.influences[end].weight;
    for (size_t i = first; i < end; ++i) out.influences[i].weight /= sum;
  }
}

/// Vertices carry no colour, materials do: every colour becomes a material of its own, the base colour times it. Exact where a triangle's
/// corners agree, as they do in hand-painted and converted models; elsewhere the triangle gets the mean of its corners, so that
/// it reflects as much as it should.
void MeshReader::applyColors(const tinygltf::Primitive& source, uint32_t material, Primitive& out) {
  constexpr size_t kMaxTints = 4096;  // materials that a file may add exactly; later ones share colours in steps of 1/16
  const FloatData colors = readAttribute(source, "COLOR_0", "VEC3 VEC4", out.positions.size(), out.place + ".attributes");
  if (colors.components == 0) return;
  const auto colorOf = [&](uint32_t vertex) {
    std::array<float, 4> color{1, 1, 1, 1};
    for (size_t c = 0; c < colors.components; ++c) {
      const float value = colors.values[vertex * colors.components + c];
      color[c] = std::isfinite(value) ? std::clamp(value, 0.f, 1.f) : 1.f;
    }
    return color;
  };
  uint64_t averaged = 0;
  for (size_t t = 0; t < out.materials.size(); ++t) {
    const std::array<float, 4> corners[3] = {colorOf(out.indices[t * 3]), colorOf(out.indices[t * 3 + 1]), colorOf(out.indices[t * 3 + 2])};
    std::array<float, 4> color = corners[0];
    if (corners[1] != color || corners[2] != color) {
      for (size_t c = 0; c < 4; ++c) {
        // In steps of 1/256, or smooth gradients would make as many materials as triangles.
        color[c] = std::round((corners[0][c] + corners[1][c] + corners[2][c]) / 3 * 256) / 256;
      }
      ++averaged;
    }
    if (tinted_.size() >= kMaxTints && !tinted_.contains({material, color})) {
      for (float& c : color) c = std::round(c * 16) / 16;
      warnings_.add("vertex colours beyond the first 4096 are rounded to steps of 1/16");
    }
    if (color == std::array<float, 4>{1, 1, 1, 1}) continue;
    const auto [known, isNew] = tinted_.try_emplace({material, color}, static_cast<uint32_t>(scene_.materials.size()));
    if (isNew) {
      shared::Material tint = scene_.materials[material];
      tint.albedo *= glm::vec3(color[0], color[1], color[2]);
      tint.alpha *= color[3];
      scene_.materials.push_back(tint);
      scene_.materialNames.push_back(scene_.materialNames[material] + ", tint " + std::to_string(tinted_.size()));
    }
    out.materials[t] = known->second;
  }
  if (averaged > 0) warnings_.add("triangles whose vertex colours differ get the mean of the three; put them into a texture", averaged);
}

}  // namespace radivox::scene::gltf
