// The two ways to bind resources, for tests that must pass on both.
#pragma once

#include "tests/oracles/gpu_fixture.h"

namespace radivox::tests {

/// The shared device (push descriptors where the driver has them) or one of our own that must do without.
class BothBindingsTest : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (!GetParam()) {
      gpu::DeviceOptions options;
      options.validation = true;
      options.pushDescriptors = false;
      options.onMessage = [this](const std::string& message) { messages_ += "\n" + message; };
      own_ = gpu::Device::create(options);
      ASSERT_FALSE(own_->capabilities().pushDescriptor);
    }
    silence_ = std::make_unique<oracles::SilenceCheck>(device());
  }
  void TearDown() override {
    silence_.reset();
    if (own_) {
      EXPECT_EQ(own_->memoryUse().allocationCount, 0u);
    }
    own_.reset();
    EXPECT_EQ(messages_, "");  // closing included: handles left behind are named there
  }
  gpu::Device& device() { return own_ ? *own_ : oracles::sharedDevice(); }
  void run(const std::function<void(gpu::Commands&)>& record) { oracles::runCommands(device(), record); }

 private:
  std::string messages_;
  std::unique_ptr<gpu::Device> own_;
  std::unique_ptr<oracles::SilenceCheck> silence_;
};

inline std::string printBinding(const ::testing::TestParamInfo<bool>& info) { return info.param ? "PushDescriptors" : "DescriptorPool"; }

}  // namespace radivox::tests
