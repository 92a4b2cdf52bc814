// Mesh primitives of a glTF document as triangle lists. Internal to engine/scene.
#pragma once

#include "engine/scene/geometry.h"
#include "engine/scene/gltf_materials.h"

namespace radivox::scene::gltf {

/// How far each vertex follows each joint of a skin.
struct SkinInfluence {
  uint32_t vertex = 0, joint = 0;
  double weight = 0;  ///< a vertex's weights sum to 1
};

/// One primitive in its mesh's space, checked: positions finite, indices in range, morph targets and texture transforms applied.
struct Primitive {
  std::string place;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;             ///< empty: the file has none
  std::vector<glm::vec2> uvBase, uvEmissive;  ///< empty: no texture reads them
  std::vector<SkinInfluence> influences;      ///< by vertex; empty: no skin moves it
  std::vector<uint32_t> indices;              ///< 3 a triangle
  std::vector<uint32_t> materials;            ///< one a triangle
};

class MeshReader {
 public:
  /// Adds materials to `scene` where vertex colours ask for them.
  MeshReader(const Document& document, const std::vector<MaterialCoordinates>& coordinates, Scene& scene, Warnings& warnings)
      : document_(document), coordinates_(coordinates), scene_(scene), warnings_(warnings) {}
  /// The mesh of a node, in the shape that the node's weights, or else the mesh's, give it. Decoded once for equal shapes.
  const std::vector<Primitive>& mesh(const tinygltf::Node& node);

 private:
  Primitive readPrimitive(const tinygltf::Primitive& source, const std::vector<double>& weights, const std::string& place);
  std::vector<glm::vec3> readVectors(const tinygltf::Primitive& source, const char* name, size_t vertexCount, const std::string& place);
  void addMorphTargets(const tinygltf::Primitive& source, const std::vector<double>& weights, Primitive& out);
  std::vector<uint32_t> readTriangles(const tinygltf::Primitive& source, size_t vertexCount, const std::string& place);
  std::vector<glm::vec2> readCoordinates(const tinygltf::Primitive& source, const TextureCoordinates& wanted, size_t vertexCount,
                                         const std::string& place);
  void readInfluences(const tinygltf::Primitive& source, Primitive& out);
  void applyColors(const tinygltf::Primitive& source, uint32_t material, Primitive& out);
  FloatData readAttribute(const tinygltf::Primitive& source, const std::string& name, std::string_view types, size_t vertexCount,
                          const std::string& place);

  const Document& document_;
  const std::vector<MaterialCoordinates>& coordinates_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<std::pair<int, std::vector<double>>, std::vector<Primitive>> meshes_;
  std::map<std::pair<uint32_t, std::array<float, 4>>, uint32_t> tinted_;  ///< material and colour → material
};

/// Adds the primitive's triangles, transformed: by `joints` (to world, one a joint) where it has influences and they are given, else by
/// `toWorld`. Winding follows the determinant's sign, so that fronts stay fronts; missing and unusable normals are replaced by geometric
/// ones. The object is called `name`. Throws BadInput naming `place` when a position leaves the range of floats.
void appendInstance(const Document& document, const Primitive& primitive, const glm::dmat4& toWorld, const std::vector<glm::dmat4>& joints,
                    const std::string& place, const std::string& name, Assembly& assembly, Warnings& warnings);

}  // namespace radivox::scene::gltf
