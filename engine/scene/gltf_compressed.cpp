#include "engine/scene/gltf_compressed.h"

#include "engine/scene/gltf_document.h"

namespace radivox::scene::gltf {

namespace {

constexpr std::string_view kDraco = "KHR_draco_mesh_compression";
constexpr std::string_view kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

}  // namespace

bool isCompression(std::string_view extension) { return extension == kDraco || extension == kMeshopt[0] || extension == kMeshopt[1]; }

bool canDecompress(std::string_view) { return false; }

void Document::decompress() {}

}  // namespace radivox::scene::gltf
