// Every Vulkan call that can fail fails once, one after the other, in an otherwise ordinary render: it ends in one error line or in the
// picture as it should be, and leaves nothing behind.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "engine/error.h"
#include "engine/scene/builtin.h"
#include "tests/oracles/pipeline.h"
#include "tests/robustness/failing_vulkan.h"

namespace radivox::tests {
namespace {

oracles::PipelineOptions tiny() {
  oracles::PipelineOptions options;
  options.settings = {{"voxelize.resolution", "8"}, {"visibility.rays", "8"}};
  options.width = 8;
  options.height = 8;
  options.bounces = 2;
  options.lights = {.shadowResolution = 16, .pointShadowResolution = 16, .emitterSamples = 0, .emitterShadowResolution = 16};
  return options;
}

/// Two frames, so that what a first one allocates is met again.
std::vector<float> render(gpu::Device& device) {
  oracles::Pipeline pipeline(device, scene::makeBuiltin("cornell_point"), tiny());
  pipeline.run();
  pipeline.run();
  return pipeline.picture("composite.color").data;
}

void expectOneLine(const Error& error, const std::string& call) {
  const std::string text = error.what();
  EXPECT_FALSE(text.empty()) << call;
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  EXPECT_TRUE(error.code() == ErrorCode::OutOfMemory || error.code() == ErrorCode::DeviceFailed) << call << ": " << text;
}

/// Fails every `stride`-th call of a render, from the `first` on.
void failCallsOfARender(uint64_t stride, uint64_t first = 1) {
  gpu::DeviceOptions options;  // no cache file: every pipeline is made anew
  const auto device = gpu::Device::create(options);
  const std::vector<float> expected = render(*device);
  failCall(0);
  ASSERT_EQ(render(*device), expected);
  const uint64_t total = callCount();
  const int64_t objects = liveObjectCount();
  const VkDeviceSize bytes = device->memoryUse().current;
  ASSERT_GT(total, 300u);
  size_t errors = 0, pictures = 0;
  for (uint64_t n = first; n <= total; n += stride) {
    failCall(n);
    try {
      const std::vector<float> picture = render(*device);
      ++pictures;
      EXPECT_EQ(picture, expected) << "call " << n << " (" << failedCall() << ") failed unnoticed";
    } catch (const Error& error) {
      ++errors;
      expectOneLine(error, failedCall());
    }
    const std::string call = failedCall();
    failCall(0);
    ASSERT_FALSE(call.empty()) << "call " << n << " of " << total << " was not made";
    ASSERT_EQ(liveObjectCount(), objects) << "after call " << n << " (" << call << ") failed";
    ASSERT_EQ(device->memoryUse().current, bytes) << "after call " << n << " (" << call << ") failed";
  }
  EXPECT_GT(errors, total / stride / 2);
  std::printf("[ figures  ] %llu calls, every %llu. failed: %zu errors, %zu pictures\n", static_cast<unsigned long long>(total),
              static_cast<unsigned long long>(stride), errors, pictures);
  EXPECT_EQ(render(*device), expected) << "the device is of no more use";
}

TEST(InjectedFailures, SomeCallsOfARenderFail) { failCallsOfARender(311); }
/// RADIVOX_EVERY_FAILURE=1: all of the thousand and more, which take minutes; =1/4 to =4/4: a quarter of them, for as many runs at once.
TEST(InjectedFailures, SlowCallsOfARenderFail) {
  const char* part = std::getenv("RADIVOX_EVERY_FAILURE");
  if (part == nullptr) return failCallsOfARender(37);
  unsigned first = 1, stride = 1;
  ASSERT_GE(std::sscanf(part, "%u/%u", &first, &stride), 1) << "RADIVOX_EVERY_FAILURE=" << part;
  ASSERT_TRUE(first >= 1 && first <= stride) << "RADIVOX_EVERY_FAILURE=" << part;
  failCallsOfARender(stride, first);
}

TEST(InjectedFailures, EveryCallOfMakingADeviceFails) {
  const int64_t objects = liveObjectCount();
  failCall(0);
  gpu::Device::create({});
  const uint64_t total = callCount();
  ASSERT_GT(total, 1u);
  for (uint64_t n = 1; n <= total; ++n) {
    failCall(n);
    try {
      gpu::Device::create({});
    } catch (const Error& error) {
      expectOneLine(error, failedCall());
    }
    failCall(0);
    EXPECT_EQ(liveObjectCount(), objects) << n;
  }
}

}  // namespace
}  // namespace radivox::tests
