#include "engine/gpu/pipeline_cache_file.h"

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace radivox::gpu {

namespace {

// Drivers check their own header but trust the bytes behind it, so a cut file can crash them; hence size and checksum of our own.
struct FileHeader {
  char magic[8];
  uint32_t vendor;
  uint32_t device;
  uint32_t driverVersion;
  uint32_t apiVersion;
  uint8_t cacheUuid[VK_UUID_SIZE];
  uint64_t dataBytes;
  uint64_t checksum;
};
static_assert(sizeof(FileHeader) == 56);

uint64_t sumFnv1a(const std::byte* data, size_t bytes) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < bytes; ++i) hash = (hash ^ static_cast<uint64_t>(data[i])) * 0x100000001b3u;
  return hash;
}

FileHeader makeHeader(const VkPhysicalDeviceProperties& properties, const std::byte* data, size_t bytes) {
  FileHeader header{};
  std::memcpy(header.magic, "RVXPIPE1", sizeof header.magic);
  header.vendor = properties.vendorID;
  header.device = properties.deviceID;
  header.driverVersion = properties.driverVersion;
  header.apiVersion = properties.apiVersion;
  std::memcpy(header.cacheUuid, properties.pipelineCacheUUID, VK_UUID_SIZE);
  header.dataBytes = bytes;
  header.checksum = sumFnv1a(data, bytes);
  return header;
}

}  // namespace

std::vector<std::byte> loadPipelineCacheFile(const std::string& file, const VkPhysicalDeviceProperties& properties) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return {};
  const auto fileBytes = static_cast<std::streamoff>(in.tellg());
  if (fileBytes <= static_cast<std::streamoff>(sizeof(FileHeader))) return {};
  std::vector<std::byte> all(static_cast<size_t>(fileBytes));
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(all.data()), fileBytes)) return {};
  std::vector<std::byte> data(all.begin() + sizeof(FileHeader), all.end());
  const FileHeader expected = makeHeader(properties, data.data(), data.size());
  if (std::memcmp(all.data(), &expected, sizeof expected) != 0) return {};
  return data;
}

bool savePipelineCacheFile(const std::string& file, const VkPhysicalDeviceProperties& properties, const std::vector<std::byte>& data) {
  std::error_code ignored;
  const std::filesystem::path target(file);
  if (target.has_parent_path()) std::filesystem::create_directories(target.parent_path(), ignored);
  const std::string temporary = file + ".tmp" + std::to_string(::getpid());
  const FileHeader header = makeHeader(properties, data.data(), data.size());
  bool written = false;
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    out.flush();
    written = out.good();
  }
  std::error_code failed;
  if (written) std::filesystem::rename(temporary, target, failed);
  if (!written || failed) {
    std::filesystem::remove(temporary, ignored);
    return false;
  }
  return true;
}

}  // namespace radivox::gpu
