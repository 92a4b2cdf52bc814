// The pipeline cache on disk. A file of another device, driver or build, a cut or damaged file: all count as no file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace radivox::gpu {

/// The driver's cache data in `file` if it is whole and was written for this device and driver; else empty.
std::vector<std::byte> loadPipelineCacheFile(const std::string& file, const VkPhysicalDeviceProperties& properties);

/// Writes beside `file` and renames, so that processes that share it read the old or the new one, never half of one. Returns false
/// when that fails: a cache that cannot be kept is no error.
bool savePipelineCacheFile(const std::string& file, const VkPhysicalDeviceProperties& properties, const std::vector<std::byte>& data);

}  // namespace radivox::gpu
