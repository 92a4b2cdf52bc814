// PNG and JPEG for glTF textures, and the one place where tinygltf is compiled.
#include <algorithm>
#include <climits>
#include <fstream>  // tinygltf's writer

#include "engine/scene/gltf_materials.h"

// Our own copy of stb, private to this file: other libraries bring theirs, whose symbols must not meet these.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#include <stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

#include <nlohmann/json.hpp>
// The header again, now with its second half: it has guards for the first only.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define tinygltf radivox_tinygltf
#include <tiny_gltf.h>
#undef tinygltf
#pragma GCC diagnostic pop

namespace radivox::scene::gltf {

namespace {

/// stb takes memory for what a PNG's chunk claims to hold, up to 2 GiB, before it looks whether it is there.
bool holdsItsChunks(std::span<const unsigned char> bytes) {
  constexpr unsigned char kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() < sizeof kSignature || !std::equal(std::begin(kSignature), std::end(kSignature), bytes.begin())) return true;
  size_t at = sizeof kSignature;
  while (at + 12 <= bytes.size()) {  // length, type, data, checksum
    const size_t length = size_t{bytes[at]} << 24 | size_t{bytes[at + 1]} << 16 | size_t{bytes[at + 2]} << 8 | size_t{bytes[at + 3]};
    if (length > bytes.size() - at - 12) return false;
    if (bytes[at + 4] == 'I' && bytes[at + 5] == 'E') return true;  // IEND; what follows is not read
    at += 12 + length;
  }
  return false;
}

}  // namespace

std::optional<TextureImage> decodeImage(std::span<const unsigned char> bytes) {
  if (bytes.size() > INT_MAX || !holdsItsChunks(bytes)) return std::nullopt;
  tinygltf::Image decoded;
  std::string ignored;
  if (!tinygltf::LoadImageData(&decoded, 0, &ignored, &ignored, 0, 0, bytes.data(), static_cast<int>(bytes.size()), nullptr))
    return std::nullopt;
  TextureImage image;
  image.width = static_cast<uint32_t>(decoded.width);
  image.height = static_cast<uint32_t>(decoded.height);
  if (decoded.bits == 16) {  // the upper byte of each, which is the second
    for (size_t i = 1; i < decoded.image.size(); i += 2) image.rgba.push_back(decoded.image[i]);
  } else {
    image.rgba = std::move(decoded.image);
  }
  return image;
}

std::vector<std::byte> encodePng(const TextureImage& image) {
  std::vector<std::byte> out;
  const auto append = [](void* context, void* data, int size) {
    auto& target = *static_cast<std::vector<std::byte>*>(context);
    const auto* from = static_cast<const std::byte*>(data);
    target.insert(target.end(), from, from + size);
  };
  stbi_write_png_to_func(append, &out, static_cast<int>(image.width), static_cast<int>(image.height), 4, image.rgba.data(),
                         static_cast<int>(image.width) * 4);
  return out;
}

}  // namespace radivox::scene::gltf
