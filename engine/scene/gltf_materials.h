// Materials and textures of a glTF document. Internal to engine/scene.
#pragma once

#include "engine/scene/gltf_document.h"
#include "engine/scene/scene.h"

namespace radivox::scene::gltf {

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

/// Decodes PNG or JPEG to RGBA through tinygltf. Nothing when it is neither, broken, or beyond 16384 texels a side.
std::optional<TextureImage> decodeImage(std::span<const unsigned char> bytes);
std::vector<std::byte> encodePng(const TextureImage& image);

}  // namespace radivox::scene::gltf
