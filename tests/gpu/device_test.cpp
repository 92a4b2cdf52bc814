// Creation, adoption, validation, and the pipeline cache file.
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "engine/gpu/device.h"
#include "engine/gpu/pipeline_cache_file.h"
#include "engine/gpu/requirements.h"
#include "engine/gpu/scan.h"
#include "tests/gpu/expect_error.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox::tests {
namespace {

/// Sets an environment variable for a scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    had_ = std::getenv(name) != nullptr;
    ::setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() {
    if (had_) {
      ::setenv(name_, old_.c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::string old_;
  bool had_ = false;
};

void expectScanWorks(gpu::Device& device) {
  const gpu::Scan scan(device);
  gpu::Buffer items(device, "items", 5000 * 4);
  gpu::Buffer scratch(device, "scratch", gpu::Scan::scratchBytes(5000));
  gpu::upload(device, items, std::vector<uint32_t>(5000, 3));
  oracles::runCommands(device, [&](gpu::Commands& commands) { scan.scan(commands, items, items, 5000, scratch); });
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device, items, 5000)[4999], 3u * 4999u);
}

TEST(DeviceTest, ReportsWhatItCan) {
  const auto device = gpu::Device::create();
  const gpu::Capabilities& can = device->capabilities();
  EXPECT_FALSE(can.deviceName.empty());
  EXPECT_FALSE(can.driverName.empty());
  EXPECT_GE(can.apiVersion, VK_API_VERSION_1_3);
  EXPECT_GE(can.maxStorageBufferRange, VkDeviceSize{1} << 27);
  EXPECT_GE(can.maxBufferSize, VkDeviceSize{1} << 30);
  EXPECT_GE(can.maxMemoryAllocationSize, VkDeviceSize{1} << 30);
  EXPECT_GE(can.maxImageDimension2D, 4096u);
  EXPECT_GE(can.maxComputeWorkGroupCount, gpu::Commands::kMaxGroupsX);
  EXPECT_LE(can.storageOffsetAlignment, 256u);
  EXPECT_GT(can.deviceLocalBytes, 0u);
  EXPECT_GT(can.subgroupSize, 0u);
  EXPECT_EQ(can.pushDescriptor, device->cmdPushDescriptorSet != nullptr);
  expectScanWorks(*device);
}

TEST(DeviceTest, OptionsHideExtensions) {
  gpu::DeviceOptions options;
  options.pushDescriptors = false;
  options.conservativeRasterization = false;
  const auto device = gpu::Device::create(options);
  EXPECT_FALSE(device->capabilities().pushDescriptor);
  EXPECT_FALSE(device->capabilities().conservativeRasterization);
  EXPECT_EQ(device->cmdPushDescriptorSet, nullptr);
}

TEST(DeviceTest, AnIndexOutOfRangeListsTheDevices) {
  const std::string name = gpu::Device::create()->capabilities().deviceName;
  for (int index : {99, -2}) {
    gpu::DeviceOptions options;
    options.index = index;
    expectError(catchError([&] { gpu::Device::create(options); }), ErrorCode::Unsupported, std::to_string(index));
  }
  gpu::DeviceOptions first;
  first.index = 0;
  EXPECT_FALSE(gpu::Device::create(first)->capabilities().deviceName.empty());
  gpu::DeviceOptions wrong;
  wrong.index = 99;
  expectError(catchError([&] { gpu::Device::create(wrong); }), ErrorCode::Unsupported, name);
}

TEST(DeviceTest, NoDriverIsSaidPlainly) {
  const ScopedVariable driver("VK_DRIVER_FILES", "/nonexistent/driver.json");
  const ScopedVariable olderName("VK_ICD_FILENAMES", "/nonexistent/driver.json");
  expectError(catchError([] { gpu::Device::create(); }), ErrorCode::Unsupported, "install mesa-vulkan-drivers");
}

TEST(DeviceTest, AMissingValidationLayerIsSaidPlainly) {
  const ScopedVariable path("VK_LAYER_PATH", "/nonexistent");
  gpu::DeviceOptions options;
  options.validation = true;
  expectError(catchError([&] { gpu::Device::create(options); }), ErrorCode::Unsupported, "install vulkan-validationlayers");
}

// Silence proves something only if the layer would have spoken: a write after a write without a barrier between.
TEST(DeviceTest, SynchronizationValidationListens) {
  std::vector<std::string> messages;
  gpu::DeviceOptions options;
  options.validation = true;
  options.onMessage = [&](const std::string& message) { messages.push_back(message); };
  const auto device = gpu::Device::create(options);
  gpu::Buffer buffer(*device, "raced", 64);
  device->submitAndWait([&](VkCommandBuffer commands) { vkCmdFillBuffer(commands, buffer.handle(), 0, 64, 1); });
  EXPECT_EQ(device->validationMessageCount(), 0u);
  device->submitAndWait([&](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, buffer.handle(), 0, 64, 1);
    vkCmdFillBuffer(commands, buffer.handle(), 0, 64, 2);
  });
  EXPECT_GE(device->validationMessageCount(), 1u);
  ASSERT_EQ(messages.size(), device->validationMessageCount());
  EXPECT_NE(messages[0].find("SYNC-HAZARD-WRITE"), std::string::npos) << messages[0];
  EXPECT_NE(messages[0].find("raced"), std::string::npos) << "object names are missing: " << messages[0];
}

// The host here is another Device, so that its validation layer watches what we do with its handles.
TEST(DeviceTest, AdoptsAHostsDeviceAndLeavesItAlive) {
  gpu::DeviceOptions options;
  options.validation = true;
  const auto host = gpu::Device::create(options);
  const gpu::DeviceRequirements requirements(host->physicalDevice());
  for (bool withExtensions : {true, false}) {
    gpu::AdoptInfo info;
    info.instance = host->instance();
    info.physicalDevice = host->physicalDevice();
    info.device = host->handle();
    info.queue = host->queue();
    info.queueFamily = host->queueFamily();
    info.debugUtils = true;
    if (withExtensions) {
      for (const char* name : requirements.extensions()) info.deviceExtensions.emplace_back(name);
    }
    const auto guest = gpu::Device::adopt(info);
    EXPECT_EQ(guest->capabilities().pushDescriptor, withExtensions && host->capabilities().pushDescriptor);
    EXPECT_EQ(guest->capabilities().geometryShader, host->capabilities().geometryShader);
    EXPECT_EQ(guest->capabilities().deviceName, host->capabilities().deviceName);
    expectScanWorks(*guest);
  }
  expectScanWorks(*host);
  EXPECT_EQ(host->validationMessageCount(), 0u);
}

TEST(DeviceTest, AdoptBelievesTheHostsFeatureChain) {
  const auto host = gpu::Device::create();
  VkPhysicalDeviceFeatures2 none{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  gpu::AdoptInfo info;
  info.instance = host->instance();
  info.physicalDevice = host->physicalDevice();
  info.device = host->handle();
  info.queue = host->queue();
  info.queueFamily = host->queueFamily();
  info.enabledFeatures = &none;
  EXPECT_FALSE(gpu::Device::adopt(info)->capabilities().geometryShader);
  info.queue = VK_NULL_HANDLE;
  expectError(catchError([&] { gpu::Device::adopt(info); }), ErrorCode::BadInput, "queue");
}

TEST(DeviceTest, RequirementsNameFeaturesAndExtensions) {
  const auto device = gpu::Device::create();
  const gpu::DeviceRequirements requirements(device->physicalDevice());
  EXPECT_TRUE(requirements.missing().empty());
  EXPECT_EQ(requirements.queueFamily(), device->queueFamily());
  const auto offered = gpu::listDeviceExtensions(device->physicalDevice());
  for (const char* name : requirements.extensions()) {
    EXPECT_NE(std::find(offered.begin(), offered.end(), name), offered.end()) << name;
  }
  EXPECT_TRUE(gpu::DeviceRequirements(device->physicalDevice(), {false, false}).extensions().empty());
}

class PipelineCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("radivox_cache_test_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    file_ = (folder_ / "deep" / "pipelines.bin").string();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A device's life with the cache: some pipelines, then the end.
  void live() {
    gpu::DeviceOptions options;
    options.pipelineCacheFile = file_;
    expectScanWorks(*gpu::Device::create(options));
  }
  std::vector<char> read() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::vector<char>& bytes) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  VkPhysicalDeviceProperties properties() const {
    VkPhysicalDeviceProperties p{};
    vkGetPhysicalDeviceProperties(oracles::sharedDevice().physicalDevice(), &p);
    return p;
  }
  std::filesystem::path folder_;
  std::string file_;
};

TEST_F(PipelineCacheTest, IsWrittenAndReadAgain) {
  live();
  const auto bytes = read();
  ASSERT_FALSE(bytes.empty());
  EXPECT_FALSE(gpu::loadPipelineCacheFile(file_, properties()).empty());
  live();
  EXPECT_EQ(read().size(), bytes.size());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
    EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << "left behind: " << entry.path();
  }
}

TEST_F(PipelineCacheTest, DamagedFilesCountAsNone) {
  live();
  const auto whole = read();
  auto refuse = [&](const std::vector<char>& bytes, const char* what) {
    write(bytes);
    EXPECT_TRUE(gpu::loadPipelineCacheFile(file_, properties()).empty()) << what;
    live();  // must neither crash nor mind
    EXPECT_EQ(read().size(), whole.size()) << what << ": not replaced by a good one";
  };
  refuse({}, "empty");
  refuse(std::vector<char>(5000, 'x'), "garbage");
  refuse({whole.begin(), whole.begin() + 40}, "cut in our header");
  refuse({whole.begin(), whole.end() - 1}, "cut in the data");
  auto longer = whole;
  longer.push_back(0);
  refuse(longer, "longer");
  auto flipped = whole;
  flipped[flipped.size() - 3] = static_cast<char>(flipped[flipped.size() - 3] ^ 1);
  refuse(flipped, "one bit flipped");
}

TEST_F(PipelineCacheTest, AnotherDeviceOrDriverCountsAsNone) {
  const std::vector<std::byte> data(100, std::byte{7});
  const VkPhysicalDeviceProperties ours = properties();
  ASSERT_TRUE(gpu::savePipelineCacheFile(file_, ours, data));
  EXPECT_EQ(gpu::loadPipelineCacheFile(file_, ours), data);
  auto other = ours;
  other.deviceID += 1;
  EXPECT_TRUE(gpu::loadPipelineCacheFile(file_, other).empty());
  other = ours;
  other.driverVersion += 1;
  EXPECT_TRUE(gpu::loadPipelineCacheFile(file_, other).empty());
  other = ours;
  other.pipelineCacheUUID[3] = static_cast<uint8_t>(other.pipelineCacheUUID[3] + 1);
  EXPECT_TRUE(gpu::loadPipelineCacheFile(file_, other).empty());
}

TEST_F(PipelineCacheTest, TwoDevicesShareAFile) {
  gpu::DeviceOptions options;
  options.pipelineCacheFile = file_;
  auto a = gpu::Device::create(options);
  auto b = gpu::Device::create(options);
  expectScanWorks(*a);
  expectScanWorks(*b);
  a.reset();
  b.reset();
  EXPECT_FALSE(gpu::loadPipelineCacheFile(file_, properties()).empty());
}

TEST_F(PipelineCacheTest, APlaceThatCannotBeWrittenIsNoError) {
  std::filesystem::create_directories(folder_);
  file_ = (folder_ / "file").string();
  write({'x'});
  file_ += "/below_a_file.bin";
  live();
  EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace radivox::tests
