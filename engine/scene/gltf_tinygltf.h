// tinygltf, compiled into the engine (gltf_images.cpp) under a name of its own. Internal to engine/scene.
//
// Not linked: Debian's libdraco exports another tinygltf under the same symbols, with other layouts, so that whichever library comes first
// in a host's link line would answer. Compiled in, it also decodes PNG and JPEG only, within bounds, and sanitizers see it.
#pragma once

#define TINYGLTF_NO_FS  // it opens no file by itself
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define tinygltf radivox_tinygltf
#include <tiny_gltf.h>
#undef tinygltf

namespace radivox::scene {
namespace tinygltf = ::radivox_tinygltf;
}
