// A validated device for tests: one per process, made at first use. Tests that need a GPU derive from GpuTest or hold a SilenceCheck:
//
//   class FacesTest : public oracles::GpuTest {};
//   TEST_F(FacesTest, …) { gpu::Buffer b(device(), "b", 64); run([&](gpu::Commands& commands) { … }); }
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"

namespace radivox::oracles {

/// The shared device with validation and synchronization validation on. Where the layer is not installed, without it (and says so
/// once on stderr), unless RADIVOX_REQUIRE_VALIDATION is set. RADIVOX_DEVICE chooses another device by index.
gpu::Device& sharedDevice();

/// All validation messages of the shared device so far, in order.
std::vector<std::string> validationMessages();

/// Fails the running test if the device says anything between construction and destruction.
class SilenceCheck {
 public:
  explicit SilenceCheck(gpu::Device& device) : device_(device), before_(device.validationMessageCount()) {}
  ~SilenceCheck();
  SilenceCheck(const SilenceCheck&) = delete;
  SilenceCheck& operator=(const SilenceCheck&) = delete;

 private:
  gpu::Device& device_;
  uint32_t before_;
};

/// Records into a fresh command buffer with a fresh descriptor pool, submits, waits.
void runCommands(gpu::Device& device, const std::function<void(gpu::Commands&)>& record);

/// Fails a test that draws a validation message or leaves device memory behind.
class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  gpu::Device& device() { return sharedDevice(); }
  void run(const std::function<void(gpu::Commands&)>& record) { runCommands(device(), record); }

 private:
  std::unique_ptr<SilenceCheck> silence_;
  VkDeviceSize bytesBefore_ = 0;
};

}  // namespace radivox::oracles
