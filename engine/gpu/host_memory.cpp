#include "engine/gpu/host_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>

namespace radivox::gpu {

namespace {

constexpr uint64_t kUnknown = std::numeric_limits<uint64_t>::max();

uint64_t readAvailable(const std::string& root) {
  std::ifstream in(root + "/proc/meminfo");
  std::string name;
  std::string unit;
  for (uint64_t kibibytes = 0; in >> name >> kibibytes; std::getline(in, unit)) {
    if (name == "MemAvailable:") return kibibytes * 1024;
  }
  return kUnknown;
}

uint64_t readNumber(const std::string& file) {
  std::ifstream in(file);
  uint64_t value = 0;
  return in >> value ? value : kUnknown;  // "max" is no number: no limit
}

uint64_t readField(const std::string& file, const std::string& field) {
  std::ifstream in(file);
  std::string name;
  for (uint64_t value = 0; in >> name >> value;) {
    if (name == field) return value;
  }
  return 0;
}

/// File names of the two versions of control groups.
struct Names {
  const char* folder;
  const char* most;
  const char* used;
  const char* cache;  ///< in memory.stat: file cache counts as used but gives way
};
constexpr Names kVersion1 = {"/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr Names kVersion2 = {"/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"};

/// The least that any level from `group` up to the root leaves.
uint64_t readLeft(const std::string& root, const Names& names, std::string group) {
  uint64_t left = kUnknown;
  while (true) {
    const std::string folder = root + names.folder + (group == "/" ? "" : group) + "/";
    const uint64_t most = readNumber(folder + names.most);
    const uint64_t used = readNumber(folder + names.used);
    if (most != kUnknown && used != kUnknown) {
      const uint64_t cache = readField(folder + "memory.stat", names.cache);
      left = std::min(left, most - std::min(most, used - std::min(used, cache)));
    }
    if (group.empty() || group == "/") return left;
    group.resize(group.rfind('/'));
  }
}

/// Lines are "0::/group" (version 2) or "4:memory:/group" (version 1).
uint64_t readControlGroups(const std::string& root) {
  std::ifstream in(root + "/proc/self/cgroup");
  std::string line;
  uint64_t left = kUnknown;
  while (std::getline(in, line)) {
    const size_t name = line.find(':');
    const size_t group = name == std::string::npos ? name : line.find(':', name + 1);
    if (group == std::string::npos || group + 1 >= line.size() || line[group + 1] != '/') continue;
    const std::string controllers = line.substr(name + 1, group - name - 1);
    if (controllers.empty()) left = std::min(left, readLeft(root, kVersion2, line.substr(group + 1)));
    if (controllers == "memory") left = std::min(left, readLeft(root, kVersion1, line.substr(group + 1)));
  }
  return left;
}

}  // namespace

uint64_t availableHostMemory(const std::string& root) { return std::min(readAvailable(root), readControlGroups(root)); }

}  // namespace radivox::gpu
