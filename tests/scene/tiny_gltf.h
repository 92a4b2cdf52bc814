// Hand-made glTF files for tests: JSON that a test may bend, and a binary buffer that goes along with it.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace radivox::tests {

/// A folder of its own for a test, removed afterwards.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string write(const std::string& name, const std::string& bytes) const;  ///< returns the path

 private:
  std::string folder_;
};

std::string readBytes(const std::string& path);
std::string encodeBase64(const std::string& bytes);

class TinyGltf {
 public:
  nlohmann::json json;
  std::string binary;

  /// asset, one scene without nodes.
  TinyGltf();

  size_t addView(const void* data, size_t bytes, size_t stride = 0);
  template <class T>
  size_t addAccessor(const std::vector<T>& data, uint32_t componentType, const std::string& type, size_t count, size_t stride = 0) {
    const size_t view = addView(data.data(), data.size() * sizeof(T), stride);
    json["accessors"].push_back({{"bufferView", view}, {"componentType", componentType}, {"type", type}, {"count", count}});
    return json["accessors"].size() - 1;
  }
  size_t addVec3(const std::vector<glm::vec3>& data) { return addAccessor(data, 5126, "VEC3", data.size()); }
  size_t addVec2(const std::vector<glm::vec2>& data) { return addAccessor(data, 5126, "VEC2", data.size()); }
  size_t addIndices(const std::vector<uint32_t>& data) { return addAccessor(data, 5125, "SCALAR", data.size()); }
  /// A mesh of one primitive.
  size_t addMesh(const nlohmann::json& primitive);
  /// A root node of the scene.
  size_t addNode(const nlohmann::json& node);
  /// A unit right triangle in the plane z = 0 that faces +z, in a node at the origin.
  void addTriangle();

  std::string gltf() const;                        ///< text with the buffer as a data URI
  std::string gltf(const std::string& uri) const;  ///< text that names an external buffer
  std::string glb() const;
};

}  // namespace radivox::tests
