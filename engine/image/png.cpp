#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "engine/error.h"
#include "engine/image/image.h"

// Our own copy, private to this file: the glTF library brings another, whose symbols must not meet these.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#include <stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace radivox::image {

float encodeSrgb(float linear) {
  if (!(linear > 0.f)) return 0.f;
  if (linear >= 1.f) return 1.f;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.f / 2.4f) - 0.055f;
}

float decodeSrgb(float encoded) { return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f); }

void writePngBytes(const std::string& path, uint32_t width, uint32_t height, uint32_t channels, const std::vector<uint8_t>& bytes) {
  if (width == 0 || height == 0 || bytes.size() != static_cast<size_t>(width) * height * channels) {
    throw Error(ErrorCode::BadInput, "cannot write '" + path + "': the image is empty or its data does not match its size");
  }
  // stb's encoder counts bytes in int.
  if (bytes.size() + height > 0x7fffffffu / 2) {
    throw Error(ErrorCode::BadInput, "cannot write '" + path + "': too large for PNG (" + std::to_string(width) + "x" +
                                         std::to_string(height) + "); write .exr instead");
  }
  std::string file;
  const auto append = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  if (stbi_write_png_to_func(append, &file, static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels), bytes.data(),
                             static_cast<int>(width * channels)) == 0) {
    throw Error(ErrorCode::OutOfMemory, "cannot write '" + path + "': not enough memory to encode it; choose a smaller --size");
  }
  writeFileAtomically(path, file);
}

void writePng(const std::string& path, const Image& linear) {
  const uint32_t channels = linear.channels;
  if (channels != 1 && channels != 3 && channels != 4) {
    throw Error(ErrorCode::BadInput,
                "cannot write '" + path + "': PNG holds 1, 3 or 4 channels, not " + std::to_string(channels) + "; write .exr instead");
  }
  std::vector<uint8_t> bytes(linear.data.size());
  for (size_t i = 0; i < linear.data.size(); ++i) {
    const float value = linear.data[i];
    const size_t pixel = i / channels;
    if (std::isnan(value)) {
      throw Error(ErrorCode::BadInput, "cannot write '" + path + "': pixel (" + std::to_string(pixel % linear.width) + ", " +
                                           std::to_string(pixel / linear.width) + ") is not a number; write .exr to inspect it");
    }
    const bool alpha = channels == 4 && i % 4 == 3;
    const float encoded = alpha ? std::fmin(std::fmax(value, 0.f), 1.f) : encodeSrgb(value);
    bytes[i] = static_cast<uint8_t>(encoded * 255.f + 0.5f);
  }
  writePngBytes(path, linear.width, linear.height, channels, bytes);
}

Image readPng(const std::string& path) {
  const auto refuse = [&path](const std::string& why) { throw Error(ErrorCode::BadInput, "cannot read '" + path + "': " + why); };
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse("no such file, or it is not readable; check the path");
  const std::vector<char> raw((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (raw.size() > 0x7fffffffu) refuse("larger than 2 GiB; convert it to .exr");
  const auto* data = reinterpret_cast<const stbi_uc*>(raw.data());
  const int size = static_cast<int>(raw.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) refuse("not a PNG image; give a .png or .exr");
  Image image;
  const auto take = [&](const auto* pixels, float largest) {
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.channels = static_cast<uint32_t>(channels);
    image.data.resize(static_cast<size_t>(image.width) * image.height * image.channels);
    const bool hasAlpha = channels == 2 || channels == 4;
    for (size_t i = 0; i < image.data.size(); ++i) {
      const float value = static_cast<float>(pixels[i]) / largest;
      const bool alpha = hasAlpha && i % image.channels == image.channels - 1;
      image.data[i] = alpha ? value : decodeSrgb(value);
    }
  };
  if (stbi_is_16_bit_from_memory(data, size) != 0) {
    stbi_us* pixels = stbi_load_16_from_memory(data, size, &width, &height, &channels, 0);
    if (pixels == nullptr) refuse(std::string("broken PNG (") + stbi_failure_reason() + "); write it again");
    take(pixels, 65535.f);
    stbi_image_free(pixels);
  } else {
    stbi_uc* pixels = stbi_load_from_memory(data, size, &width, &height, &channels, 0);
    if (pixels == nullptr) refuse(std::string("broken PNG (") + stbi_failure_reason() + "); write it again");
    take(pixels, 255.f);
    stbi_image_free(pixels);
  }
  return image;
}

}  // namespace radivox::image
