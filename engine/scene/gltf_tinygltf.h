// tinygltf, compiled into the engine (gltf_images.cpp) under a name of its own. Internal to engine/scene.
//
// Not linked: other libraries bring a tinygltf of other layouts under the same symbols (Debian's libdraco does), and the first in a host's
// link line would answer. Compiled in, it also opens no files, decodes PNG and JPEG only, within bounds, and sanitizers see it.
#pragma once

#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define tinygltf radivox_tinygltf
#include <tiny_gltf.h>
#undef tinygltf

namespace radivox::scene {
namespace tinygltf = ::radivox_tinygltf;
}
