// Compressed geometry in glTF files, where the libraries for it were found at build time. Internal to engine/scene.
#pragma once

#include <string_view>

namespace radivox::scene::gltf {

bool isCompression(std::string_view extension);
/// Whether this build reads it.
bool canDecompress(std::string_view extension);

}  // namespace radivox::scene::gltf
