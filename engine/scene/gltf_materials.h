// Materials and textures of a glTF document. Internal to engine/scene.
#pragma once

#include <map>

#include "engine/scene/gltf_document.h"
#include "engine/scene/scene.h"

namespace radivox::scene::gltf {

/// Counts equal warnings, so that a thousand bad meshes make one line.
class Warnings {
 public:
  void add(const std::string& message, uint64_t times = 1) { counts_[message] += times; }
  /// "3 × message" in the order of the text.
  void appendTo(std::vector<std::string>& lines) const;

 private:
  std::map<std::string, uint64_t> counts_;
};

/// Which texture coordinates a texture reads: set and 2 × 3 transform, applied to vertices at import.
struct TextureCoordinates {
  uint32_t set = 0;
  double a = 1, b = 0, c = 0, d = 1, offsetU = 0, offsetV = 0;  ///< u' = a·u + b·v + offsetU, v' = c·u + d·v + offsetV
};

struct MaterialCoordinates {
  std::optional<TextureCoordinates> base, emissive;  ///< nothing: no texture
};

/// Fills scene.materials, .materialNames, .textures. One entry a glTF material, in order, and glTF's default material last if
/// `wantsDefault` or there is no other.
std::vector<MaterialCoordinates> readMaterials(const Document& document, bool wantsDefault, Scene& scene, Warnings& warnings);

/// Decodes PNG or JPEG to RGBA. Nothing when it is neither or broken.
std::optional<TextureImage> decodeImage(std::span<const std::byte> bytes);
std::vector<std::byte> encodePng(const TextureImage& image);

}  // namespace radivox::scene::gltf
