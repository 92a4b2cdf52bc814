// Scene → .glb: one mesh with a primitive for each material, so that what importGltf reads back is the same scene.
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/image/image.h"
#include "engine/scene/geometry.h"
#include "engine/scene/gltf.h"
#include "engine/scene/gltf_materials.h"

namespace radivox::scene {

namespace {

using nlohmann::json;

constexpr uint32_t kUnusedVertex = 0xffffffffu;

template <class V>
json toJson(const V& v, glm::length_t count) {
  json out = json::array();
  for (glm::length_t i = 0; i < count; ++i) out.push_back(static_cast<double>(v[i]));
  return out;
}

json toJson(const glm::quat& q) { return json::array({q.x, q.y, q.z, q.w}); }

class GlbWriter {
 public:
  explicit GlbWriter(const Scene& scene) : scene_(scene) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "radivox"}};
    root_["scene"] = 0;
    root_["nodes"] = json::array();
    writeMaterials();
    writeMesh();
    writeLights();
    writeCameras();
    json gltfScene = {{"nodes", json::array()}};
    for (size_t i = 0; i < root_["nodes"].size(); ++i) gltfScene["nodes"].push_back(i);
    if (scene.skyRadiance != glm::vec3(0.f)) gltfScene["extras"]["radivox"]["skyRadiance"] = toJson(scene.skyRadiance, 3);
    root_["scenes"] = json::array({gltfScene});
    if (!extensions_.empty()) root_["extensionsUsed"] = extensions_;
    if (!binary_.empty()) root_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  }

  /// Throws OutOfMemory beyond the 4 GiB that a GLB can hold.
  std::string assemble() const {
    std::string text = root_.dump();
    text.append((4 - text.size() % 4) % 4, ' ');
    const uint64_t length = 12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size());
    if (length > std::numeric_limits<uint32_t>::max()) {
      throw Error(ErrorCode::OutOfMemory,
                  scene_.name + ": needs " + std::to_string(length) + " bytes, a .glb holds at most 4 GiB; simplify the scene");
    }
    std::string out = "glTF";
    appendWord(out, 2);
    appendWord(out, static_cast<uint32_t>(length));
    appendWord(out, static_cast<uint32_t>(text.size()));
    out += "JSON" + text;
    if (!binary_.empty()) {
      appendWord(out, static_cast<uint32_t>(binary_.size()));
      out.append("BIN\0", 4);
      out += binary_;
    }
    return out;
  }

 private:
  static void appendWord(std::string& out, uint32_t word) { out.append(reinterpret_cast<const char*>(&word), sizeof word); }

  void useExtension(const std::string& name) {
    for (const auto& known : extensions_) {
      if (known == name) return;
    }
    extensions_.push_back(name);
  }

  size_t addView(const void* data, size_t bytes) {
    json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}};
    if (bytes > 0) binary_.append(static_cast<const char*>(data), bytes);
    binary_.append((4 - binary_.size() % 4) % 4, '\0');
    root_["bufferViews"].push_back(view);
    return root_["bufferViews"].size() - 1;
  }

  template <class T>
  size_t addAccessor(const std::vector<T>& data, uint32_t componentType, const char* type) {
    root_["accessors"].push_back({{"bufferView", addView(data.data(), data.size() * sizeof(T))},
                                  {"componentType", componentType},
                                  {"count", data.size()},
                                  {"type", type}});
    return root_["accessors"].size() - 1;
  }

  size_t addTexture(uint32_t index) {
    const TextureImage& image = scene_.textures[index];
    const auto png = gltf::encodePng(image);
    root_["images"].push_back({{"bufferView", addView(png.data(), png.size())}, {"mimeType", "image/png"}});
    if (!image.name.empty()) root_["images"].back()["name"] = image.name;
    const auto wrap = [](uint32_t mode) { return mode == shared::kWrapClamp ? 33071 : mode == shared::kWrapMirror ? 33648 : 10497; };
    json sampler = {{"wrapS", wrap(image.wrapU)}, {"wrapT", wrap(image.wrapV)}, {"magFilter", image.nearest ? 9728 : 9729}};
    root_["samplers"].push_back(sampler);
    root_["textures"].push_back({{"source", root_["images"].size() - 1}, {"sampler", root_["samplers"].size() - 1}});
    return root_["textures"].size() - 1;
  }

  /// The emissive texture reads set 1 when the base colour texture has set 0.
  static bool hasTwoSets(const shared::Material& m) {
    return m.baseTexture != shared::kNoTexture && m.emissiveTexture != shared::kNoTexture;
  }

  void writeMaterials() {
    for (uint32_t i = 0; i < scene_.textures.size(); ++i) addTexture(i);
    for (size_t i = 0; i < scene_.materials.size(); ++i) {
      const shared::Material& m = scene_.materials[i];
      json pbr = {{"baseColorFactor", toJson(glm::vec4(m.albedo, m.alpha), 4)}, {"metallicFactor", 0.0}};
      if (m.baseTexture != shared::kNoTexture) pbr["baseColorTexture"] = {{"index", m.baseTexture}};
      json material = {{"pbrMetallicRoughness", pbr}};
      if (i < scene_.materialNames.size()) material["name"] = scene_.materialNames[i];
      const double strongest = std::max({m.emission.x, m.emission.y, m.emission.z});
      if (strongest > 0) {
        const double strength = std::max(strongest, 1.0);
        material["emissiveFactor"] = toJson(glm::dvec3(m.emission) / strength, 3);
        if (strength > 1) {
          material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
          useExtension("KHR_materials_emissive_strength");
        }
        if (m.emissiveTexture != shared::kNoTexture) {
          material["emissiveTexture"] = {{"index", m.emissiveTexture}, {"texCoord", hasTwoSets(m) ? 1 : 0}};
        }
      }
      if ((m.flags & shared::kMaterialAlphaMask) != 0u) {
        material["alphaMode"] = "MASK";
        material["alphaCutoff"] = static_cast<double>(m.alphaCutoff);
      }
      if ((m.flags & shared::kMaterialDoubleSided) != 0u) material["doubleSided"] = true;
      root_["materials"].push_back(material);
    }
  }

  json writePrimitive(uint32_t material, const std::vector<uint32_t>& triangles, std::vector<uint32_t>& newIndex) {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> base, emissive;
    std::vector<uint32_t> indices, used;
    glm::vec3 min(std::numeric_limits<float>::max()), max(std::numeric_limits<float>::lowest());
    // Vertices keep their order, so that writing what was read gives the same bytes.
    for (const uint32_t t : triangles) {
      for (uint32_t k = 0; k < 3; ++k) used.push_back(scene_.indices[t * size_t{3} + k]);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const uint32_t i : used) {
      const shared::Vertex& vertex = scene_.vertices[i];
      newIndex[i] = static_cast<uint32_t>(positions.size());
      positions.push_back(vertex.position);
      normals.push_back(vertex.normal);
      base.push_back(vertex.uvBase);
      emissive.push_back(vertex.uvEmissive);
      min = glm::min(min, vertex.position);
      max = glm::max(max, vertex.position);
    }
    for (const uint32_t t : triangles) {
      for (uint32_t k = 0; k < 3; ++k) indices.push_back(newIndex[scene_.indices[t * size_t{3} + k]]);
    }
    const shared::Material& m = scene_.materials[material];
    json attributes;
    attributes["POSITION"] = addAccessor(positions, 5126, "VEC3");
    root_["accessors"].back()["min"] = toJson(min, 3);
    root_["accessors"].back()["max"] = toJson(max, 3);
    attributes["NORMAL"] = addAccessor(normals, 5126, "VEC3");
    if (m.baseTexture != shared::kNoTexture) attributes["TEXCOORD_0"] = addAccessor(base, 5126, "VEC2");
    if (m.emissiveTexture != shared::kNoTexture)
      attributes[hasTwoSets(m) ? "TEXCOORD_1" : "TEXCOORD_0"] = addAccessor(emissive, 5126, "VEC2");
    return {{"attributes", attributes}, {"indices", addAccessor(indices, 5125, "SCALAR")}, {"material", material}};
  }

  void writeMesh() {
    if (scene_.triangleCount() == 0) return;
    std::vector<std::vector<uint32_t>> byMaterial(scene_.materials.size());
    for (size_t t = 0; t < scene_.triangleCount(); ++t) byMaterial[scene_.triangleMaterials[t]].push_back(static_cast<uint32_t>(t));
    std::vector<uint32_t> newIndex(scene_.vertices.size(), kUnusedVertex);
    json primitives = json::array();
    for (uint32_t m = 0; m < byMaterial.size(); ++m) {
      if (!byMaterial[m].empty()) primitives.push_back(writePrimitive(m, byMaterial[m], newIndex));
    }
    root_["meshes"] = json::array({{{"primitives", primitives}}});
    json node = {{"mesh", 0}, {"name", "scene"}};
    if (scene_.origin != glm::dvec3(0.0)) node["translation"] = toJson(scene_.origin, 3);
    root_["nodes"].push_back(node);
  }

  void addNode(const std::string& name, const glm::vec3& position, const glm::quat& orientation, const json& content) {
    json node = content;
    node["name"] = name;
    node["translation"] = toJson(scene_.origin + glm::dvec3(position), 3);
    node["rotation"] = toJson(orientation);
    root_["nodes"].push_back(node);
  }

  void writeLights() {
    json lights = json::array();
    for (const PunctualLight& light : scene_.lights) {
      const double strongest = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
      json out = {{"name", light.name}};
      out["type"] = light.type == shared::kLightDirectional ? "directional" : light.type == shared::kLightPoint ? "point" : "spot";
      out["intensity"] = strongest;
      if (strongest > 0) out["color"] = toJson(glm::dvec3(light.intensity) / strongest, 3);
      if (light.range > 0.f) out["range"] = static_cast<double>(light.range);
      if (light.type == shared::kLightSpot) {
        out["spot"] = {{"innerConeAngle", static_cast<double>(light.innerConeAngle)},
                       {"outerConeAngle", static_cast<double>(light.outerConeAngle)}};
      }
      lights.push_back(out);
      const json reference = {{"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
      addNode(light.name, light.position, orientationFrom(glm::dvec3(light.direction), glm::dvec3(0, 1, 0)), reference);
    }
    if (lights.empty()) return;
    root_["extensions"]["KHR_lights_punctual"]["lights"] = lights;
    useExtension("KHR_lights_punctual");
  }

  void writeCameras() {
    for (const CameraDescription& camera : scene_.cameras) {
      json out;
      if (camera.orthographic) {
        out["type"] = "orthographic";
        out["orthographic"] = {{"xmag", static_cast<double>(camera.ymag)},
                               {"ymag", static_cast<double>(camera.ymag)},
                               {"znear", static_cast<double>(camera.znear)},
                               {"zfar", static_cast<double>(camera.zfar)}};
      } else {
        out["type"] = "perspective";
        out["perspective"] = {{"yfov", static_cast<double>(camera.yfov)}, {"znear", static_cast<double>(camera.znear)}};
      }
      root_["cameras"].push_back(out);
      addNode(camera.name, camera.position, camera.orientation, {{"camera", root_["cameras"].size() - 1}});
    }
  }

  const Scene& scene_;
  json root_;
  std::string binary_;
  std::vector<std::string> extensions_;
};

}  // namespace

void exportGlb(const Scene& scene, const std::string& path) { image::writeFileAtomically(path, GlbWriter(scene).assemble()); }

}  // namespace radivox::scene
