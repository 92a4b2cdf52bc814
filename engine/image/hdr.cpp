// Radiance's .hdr (RGBE), by stb.
#include <climits>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "engine/error.h"
#include "engine/image/image.h"

// Our own copy, private to this file: other libraries bring theirs, whose symbols must not meet these.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace radivox::image {

Image readHdr(const std::string& path) {
  const auto refuse = [&path](const std::string& why) { throw Error(ErrorCode::BadInput, "cannot read '" + path + "': " + why); };
  if (std::filesystem::is_directory(path)) refuse("it is a folder; give a .hdr file");
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse("no such file, or it is not readable; check the path");
  if (!std::filesystem::is_regular_file(path)) refuse("it is not a regular file; give a .hdr file");
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (bytes.size() > INT_MAX) refuse("it is larger than 2 GiB; save a smaller image");
  const auto* from = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_is_hdr_from_memory(from, length) == 0 || stbi_info_from_memory(from, length, &width, &height, &channels) == 0)
    refuse("it does not begin as Radiance's .hdr files do; save it as .hdr (RGBE), or as .exr");
  // Each row takes four bytes at least, and eight where more than 127 texels repeat.
  if (static_cast<uint64_t>(height) * 4 + static_cast<uint64_t>(width) * static_cast<uint64_t>(height) / 32 > bytes.size())
    refuse("it claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels, but is far too short; copy it again");
  const std::unique_ptr<float, void (*)(void*)> texels(stbi_loadf_from_memory(from, length, &width, &height, &channels, 3),
                                                       stbi_image_free);
  if (!texels) refuse(std::string(stbi_failure_reason()) + "; copy it again, or save it as .exr");
  Image image;
  image.width = static_cast<uint32_t>(width);
  image.height = static_cast<uint32_t>(height);
  image.data.assign(texels.get(), texels.get() + size_t{image.width} * image.height * 3);
  return image;
}

}  // namespace radivox::image
