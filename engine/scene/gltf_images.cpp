// PNG and JPEG for glTF textures.
#include <climits>

#include "engine/scene/gltf_materials.h"

// Our own copy, private to this file: other libraries bring theirs, whose symbols must not meet these.
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
#pragma GCC diagnostic pop

namespace radivox::scene::gltf {

std::optional<TextureImage> decodeImage(std::span<const std::byte> bytes) {
  if (bytes.empty() || bytes.size() > INT_MAX) return std::nullopt;
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width, &height, &channels, 4);
  if (pixels == nullptr) return std::nullopt;
  TextureImage image;
  image.width = static_cast<uint32_t>(width);
  image.height = static_cast<uint32_t>(height);
  image.rgba.assign(pixels, pixels + static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  stbi_image_free(pixels);
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
