#include "samples/cli/cache.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace radivox::cli {

std::string pipelineCacheFile() {
  if (const char* chosen = std::getenv("RADIVOX_PIPELINE_CACHE")) return chosen;
  std::filesystem::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && cache[0] == '/') {
    folder = cache;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    folder = std::filesystem::path(home) / ".cache";
  } else {
    return {};
  }
  folder /= "radivox";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return error ? std::string() : (folder / "pipelines").string();
}

}  // namespace radivox::cli
