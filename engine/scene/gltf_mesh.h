// Mesh primitives of a glTF document as triangle lists. Internal to engine/scene.
#pragma once

#include "engine/scene/geometry.h"
#include "engine/scene/gltf_materials.h"

namespace radivox::scene::gltf {

/// One primitive in its mesh's space, checked: positions finite, indices in range, texture transforms applied.
struct Primitive {
  std::string place;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;             ///< empty: the file has none
  std::vector<glm::vec2> uvBase, uvEmissive;  ///< empty: no texture reads them
  std::vector<uint32_t> indices;              ///< 3 a triangle
  uint32_t material = 0;
};

class MeshReader {
 public:
  MeshReader(const Document& document, const std::vector<MaterialCoordinates>& coordinates, Warnings& warnings)
      : document_(document), coordinates_(coordinates), warnings_(warnings), meshes_(document.count("meshes")) {}
  /// Decoded once, however many nodes use it.
  const std::vector<Primitive>& mesh(size_t index);

 private:
  Primitive readPrimitive(const Value& json);
  std::vector<uint32_t> readTriangles(const Value& json, size_t vertexCount);
  std::vector<glm::vec2> readCoordinates(const Value& attributes, const TextureCoordinates& wanted, size_t vertexCount);
  void warnAboutColors(const Value& attributes);
  const Document& document_;
  const std::vector<MaterialCoordinates>& coordinates_;
  Warnings& warnings_;
  std::vector<std::optional<std::vector<Primitive>>> meshes_;
};

/// Adds the primitive's triangles, transformed. Winding follows the determinant's sign, so that fronts stay fronts; missing and unusable
/// normals are replaced by geometric ones. Throws BadInput naming `node` when a position leaves the range of floats.
void appendInstance(const Primitive& primitive, const glm::dmat4& toWorld, const Value& node, Assembly& assembly, Warnings& warnings);

}  // namespace radivox::scene::gltf
