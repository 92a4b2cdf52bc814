#include "engine/gpu/host_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

namespace radivox::tests {
namespace {

constexpr uint64_t kUnknown = std::numeric_limits<uint64_t>::max();

TEST(HostMemoryTest, IsWithinWhatTheMachineHas) {
  const uint64_t available = gpu::availableHostMemory();
  const auto installed = static_cast<uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
  EXPECT_GT(available, uint64_t{16} << 20);
  EXPECT_LE(available, installed);
}

/// A made-up /proc and /sys.
class FakeMachineTest : public ::testing::Test {
 protected:
  void SetUp() override { root_ = std::filesystem::temp_directory_path() / ("radivox_machine_" + std::to_string(::getpid())); }
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& file, const std::string& text) const {
    const std::filesystem::path path = root_.string() + file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  uint64_t measure() const { return gpu::availableHostMemory(root_.string()); }
  std::filesystem::path root_;
};

TEST_F(FakeMachineTest, NothingToRead) { EXPECT_EQ(measure(), kUnknown); }

TEST_F(FakeMachineTest, WithoutControlGroups) {
  write("/proc/meminfo", "MemTotal:       2000 kB\nMemFree:         100 kB\nMemAvailable:   1500 kB\nSwapFree:  0 kB\n");
  EXPECT_EQ(measure(), 1500u * 1024);
}

TEST_F(FakeMachineTest, Version2TakesTheTightestLevel) {
  write("/proc/meminfo", "MemTotal: 2000 kB\nMemAvailable: 1500 kB\n");
  write("/proc/self/cgroup", "0::/outer/inner\n");
  write("/sys/fs/cgroup/outer/inner/memory.max", "max\n");
  write("/sys/fs/cgroup/outer/inner/memory.current", "500\n");
  EXPECT_EQ(measure(), 1500u * 1024);
  write("/sys/fs/cgroup/outer/memory.max", "10000\n");
  write("/sys/fs/cgroup/outer/memory.current", "6000\n");
  EXPECT_EQ(measure(), 4000u);
  write("/sys/fs/cgroup/outer/memory.stat", "anon 17\nfile 2600\ninactive_file 2500\n");
  EXPECT_EQ(measure(), 6500u);
  write("/sys/fs/cgroup/outer/memory.current", "20000\n");
  EXPECT_EQ(measure(), 0u);
}

TEST_F(FakeMachineTest, Version1) {
  write("/proc/meminfo", "MemTotal: 2000 kB\nMemAvailable: 1500 kB\n");
  write("/proc/self/cgroup", "9:name=systemd:/\n4:memory:/job\n1:cpu:/\n0::/\n");
  write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("/sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n");
  EXPECT_EQ(measure(), 1500u * 1024);
  write("/sys/fs/cgroup/memory/job/memory.limit_in_bytes", "70000\n");
  write("/sys/fs/cgroup/memory/job/memory.usage_in_bytes", "50000\n");
  write("/sys/fs/cgroup/memory/job/memory.stat", "inactive_file 3\ntotal_inactive_file 1000\n");
  EXPECT_EQ(measure(), 21000u);
}

}  // namespace
}  // namespace radivox::tests
