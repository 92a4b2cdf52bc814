// PNG and JPEG for glTF textures.
#include <climits>
#include <cstring>

#include "engine/scene/gltf_materials.h"

// Our own copy, private to this file: other libraries bring theirs, whose symbols must not meet these.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace radivox::scene::gltf {

namespace {

constexpr uint64_t kMaxSide = 16384;

struct Size {
  uint64_t width = 0, height = 0;
  uint64_t bits = 8;  ///< a channel
  /// tinygltf counts the bytes in an int.
  bool isDecodable() const {
    return width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide && width * height * 4 * (bits / 8) <= INT_MAX;
  }
};

uint64_t readBigEndian(const unsigned char* from, size_t count) {
  uint64_t value = 0;
  for (size_t i = 0; i < count; ++i) value = value << 8 | from[i];
  return value;
}

/// As the header has it; zeros when it is neither PNG nor JPEG. Read here because tinygltf decodes whatever stb knows, at any size.
Size readSize(std::span<const unsigned char> bytes) {
  constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() > 24 && std::memcmp(bytes.data(), kPng, sizeof kPng) == 0)
    return {readBigEndian(&bytes[16], 4), readBigEndian(&bytes[20], 4), bytes[24] == 16 ? 16u : 8u};
  if (bytes.size() < 4 || bytes[0] != 0xff || bytes[1] != 0xd8) return {};
  for (size_t at = 2; at + 9 <= bytes.size();) {  // a JPEG's segments, up to a start of frame
    const unsigned char marker = bytes[at + 1];
    if (bytes[at] != 0xff || marker == 0xff) {
      ++at;  // padding
    } else if (marker >= 0xc0 && marker <= 0xc2) {
      return {readBigEndian(&bytes[at + 7], 2), readBigEndian(&bytes[at + 5], 2)};
    } else {
      at += 2 + readBigEndian(&bytes[at + 2], 2);
    }
  }
  return {};
}

}  // namespace

std::optional<TextureImage> decodeImage(std::span<const unsigned char> bytes) {
  const Size size = readSize(bytes);
  if (!size.isDecodable() || bytes.size() > INT_MAX) return std::nullopt;
  tinygltf::Image decoded;
  std::string ignored;
  // Holding tinygltf to the size that was checked: a JPEG may have another start of frame.
  if (!tinygltf::LoadImageData(&decoded, 0, &ignored, &ignored, static_cast<int>(size.width), static_cast<int>(size.height), bytes.data(),
                               static_cast<int>(bytes.size()), nullptr))
    return std::nullopt;
  TextureImage image;
  image.width = static_cast<uint32_t>(size.width);
  image.height = static_cast<uint32_t>(size.height);
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
