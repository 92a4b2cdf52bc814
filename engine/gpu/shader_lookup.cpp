#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

#include "engine/gpu/embedded_shaders.h"
#include "engine/gpu/pipeline.h"

namespace radivox::gpu {

namespace {

constexpr uint32_t kSpirvMagic = 0x07230203u;

/// RADIVOX_SHADER_DIR/NAME.spv, read anew each time so that an edited shader shows. The words must outlive the call, so this
/// development path alone keeps them for the life of the process.
std::span<const uint32_t> findShaderOnDisk(const std::string& folder, std::string_view name) {
  const std::string file = folder + "/" + std::string(name) + ".spv";
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return {};
  const auto bytes = static_cast<size_t>(in.tellg());
  std::vector<uint32_t> words(bytes / 4);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(words.size() * 4));
  if (!in || bytes % 4 != 0 || words.size() < 5 || words[0] != kSpirvMagic) {
    throw Error(ErrorCode::BadInput,
                file + ": not SPIR-V; compile it with glslangValidator --target-env vulkan1.3 or unset RADIVOX_SHADER_DIR");
  }
  static std::mutex mutex;
  static std::map<std::string, std::vector<std::vector<uint32_t>>, std::less<>> loaded;
  std::lock_guard lock(mutex);
  auto& versions = loaded[file];
  for (const auto& version : versions) {
    if (version == words) return version;
  }
  return versions.emplace_back(std::move(words));
}

}  // namespace

std::span<const uint32_t> findShader(std::string_view name) {
  if (const char* folder = std::getenv("RADIVOX_SHADER_DIR"); folder != nullptr && *folder != '\0') {
    const auto words = findShaderOnDisk(folder, name);
    if (!words.empty()) return words;
  }
  const EmbeddedShader* table = embeddedShaders();
  for (size_t i = 0; i < embeddedShaderCount(); ++i) {
    if (name == table[i].name) return {table[i].words, table[i].wordCount};
  }
  throw Error(ErrorCode::BadInput, "no shader " + std::string(name) + " is built in; shaders are named by their path under shaders/");
}

}  // namespace radivox::gpu
