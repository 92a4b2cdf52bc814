// Memory counts, limits and injected failures; copies.
#include <numeric>

#include "tests/gpu/expect_error.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox::tests {
namespace {

class MemoryTest : public oracles::GpuTest {};

TEST_F(MemoryTest, EveryAllocationIsCounted) {
  const gpu::MemoryUse before = device().memoryUse();
  device().resetPeakMemory();
  EXPECT_EQ(device().memoryUse().peak, before.current);
  {
    gpu::Buffer a(device(), "a", 1 << 20);
    gpu::Buffer b(device(), "b", 3 << 20, gpu::MemoryKind::ReadBack);
    gpu::Image c(device(), "c", {.width = 64, .height = 64});
    const gpu::MemoryUse now = device().memoryUse();
    EXPECT_GE(now.current - before.current, (4u << 20) + 64 * 64 * 16);
    EXPECT_EQ(now.allocationCount - before.allocationCount, 3u);
    gpu::Buffer moved(std::move(b));
    EXPECT_EQ(device().memoryUse().current, now.current);
    EXPECT_NE(moved.mapped(), nullptr);
    a = gpu::Buffer();
    EXPECT_EQ(device().memoryUse().allocationCount - before.allocationCount, 2u);
    EXPECT_EQ(device().memoryUse().peak, now.current);
  }
  EXPECT_EQ(device().memoryUse().current, before.current);
  EXPECT_EQ(device().memoryUse().allocationCount, before.allocationCount);
  EXPECT_GT(device().memoryUse().peak, before.current);
}

TEST_F(MemoryTest, SizesPastTheLimitsAreRefusedBeforeTheDriverSeesThem) {
  const gpu::Capabilities& can = device().capabilities();
  const auto before = device().memoryUse();
  expectError(catchError([&] { gpu::Buffer(device(), "huge", can.maxBufferSize + 1); }), ErrorCode::OutOfMemory, "buffer huge");
  expectError(catchError([&] { gpu::Buffer(device(), "wrapping", ~VkDeviceSize{0}); }), ErrorCode::OutOfMemory, "buffer wrapping");
  VkMemoryRequirements needs{can.maxMemoryAllocationSize + 1, 16, ~0u};
  expectError(catchError([&] { device().allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, false); }), ErrorCode::OutOfMemory,
              "cannot allocate");
  needs = {16, 16, 0};
  expectError(catchError([&] { device().allocate(needs, 0, false); }), ErrorCode::OutOfMemory, "no memory type");
  expectError(catchError([&] { gpu::Image(device(), "wide", {.width = can.maxImageDimension2D + 1}); }), ErrorCode::OutOfMemory,
              "image wide");
  expectError(catchError([&] { gpu::Image(device(), "deep", {.layers = can.maxImageArrayLayers + 1}); }), ErrorCode::OutOfMemory,
              "image deep");
  expectError(catchError([&] { gpu::Image(device(), "flat", {.height = 0}); }), ErrorCode::BadInput, "image flat");
  EXPECT_EQ(device().memoryUse().current, before.current);
}

// Allocates until the device, or the machine behind a CPU device, says no; then goes on working. The memory is never touched.
TEST_F(MemoryTest, RunningOutIsAnErrorAndNotTheEnd) {
  const VkDeviceSize piece = std::min<VkDeviceSize>(device().capabilities().maxMemoryAllocationSize, VkDeviceSize{1} << 30);
  std::vector<gpu::Buffer> held;
  const Error error = catchError([&] {
    for (int i = 0; i < 4096; ++i) held.emplace_back(device(), "piece", piece);
  });
  expectError(error, ErrorCode::OutOfMemory, "cannot allocate");
  expectError(error, ErrorCode::OutOfMemory, "buffer piece");
  held.clear();
  gpu::Buffer small(device(), "small", 64);
  gpu::upload(device(), small, std::vector<uint32_t>(16, 5));
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), small, 16), std::vector<uint32_t>(16, 5));
}

TEST_F(MemoryTest, InjectedFailuresLeaveNothingBehind) {
  const auto before = device().memoryUse();
  device().failAfter(1);
  expectError(catchError([&] { gpu::Buffer(device(), "b", 64); }), ErrorCode::OutOfMemory, "buffer b: ");
  device().failAfter(1);
  expectError(catchError([&] { gpu::Image(device(), "i", {}); }), ErrorCode::OutOfMemory, "image i: ");
  device().failAfter(1);
  expectError(catchError([&] { device().submitAndWait([](VkCommandBuffer) {}); }), ErrorCode::DeviceFailed, "vkQueueSubmit2");
  EXPECT_EQ(device().memoryUse().current, before.current);

  // The third from now on: two allocations pass. An upload is a staging allocation and a submission.
  device().failAfter(3);
  gpu::Buffer buffer(device(), "passes", 64);
  expectError(catchError([&] { gpu::upload(device(), buffer, std::vector<uint32_t>(16, 1)); }), ErrorCode::DeviceFailed, "injected");
  gpu::upload(device(), buffer, std::vector<uint32_t>(16, 2));  // counted down once, and never again
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), buffer, 16), std::vector<uint32_t>(16, 2));

  device().failAfter(1);
  expectError(catchError([&] { gpu::DescriptorPool pool(device()); }), ErrorCode::OutOfMemory, "placeholder");
  device().failAfter(8);  // after the placeholders' seven allocations comes the submission that clears them
  expectError(catchError([&] { gpu::DescriptorPool pool(device()); }), ErrorCode::DeviceFailed, "vkQueueSubmit2");
  device().failAfter(0);
}

TEST_F(MemoryTest, ARecorderThatThrowsLeavesTheQueueUsable) {
  expectError(catchError([&] { device().submitAndWait([](VkCommandBuffer) { throw Error(ErrorCode::BadInput, "stop"); }); }),
              ErrorCode::BadInput, "stop");
  run([](gpu::Commands&) {});
}

TEST_F(MemoryTest, CopiesReachEveryByte) {
  // Past the staging size, so that copies go in pieces; odd sizes and offsets.
  const size_t words = (size_t{70} << 20) / 4 + 3;
  std::vector<uint32_t> data(words);
  std::iota(data.begin(), data.end(), 17u);
  gpu::Buffer buffer(device(), "large", words * 4);
  gpu::upload(device(), buffer, data);
  EXPECT_TRUE(gpu::downloadAs<uint32_t>(device(), buffer, words) == data);

  for (gpu::MemoryKind kind : {gpu::MemoryKind::Device, gpu::MemoryKind::Upload, gpu::MemoryKind::ReadBack}) {
    gpu::Buffer odd(device(), "odd", 13, kind);
    EXPECT_EQ(odd.bytes(), 13u);
    EXPECT_NE(odd.address(), 0u);
    const std::vector<std::byte> zeros(13, std::byte{0});
    const std::vector<std::byte> bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
    gpu::upload(device(), odd, zeros);
    gpu::upload(device(), odd, bytes, 10);
    EXPECT_EQ(gpu::download(device(), odd, 9), (std::vector<std::byte>{std::byte{0}, std::byte{1}, std::byte{2}, std::byte{3}}));
    EXPECT_EQ(gpu::download(device(), odd, 11, 1), std::vector<std::byte>{std::byte{2}});
    EXPECT_TRUE(gpu::download(device(), odd, 13).empty());
    expectError(catchError([&] { gpu::upload(device(), odd, bytes, 11); }), ErrorCode::BadInput, "buffer odd");
    expectError(catchError([&] { gpu::download(device(), odd, 12, 2); }), ErrorCode::BadInput, "buffer odd");
    expectError(catchError([&] { gpu::download(device(), odd, 14); }), ErrorCode::BadInput, "buffer odd");
  }
  gpu::Buffer empty(device(), "empty", 0);
  EXPECT_EQ(empty.bytes(), 16u);
}

TEST_F(MemoryTest, BuffersShareMemoryThatTheCallerOwns) {
  const VkMemoryRequirements needs = gpu::Buffer::requirements(device(), 1000);
  EXPECT_GE(needs.size, 1000u);
  const VkDeviceSize second = (needs.size + needs.alignment - 1) / needs.alignment * needs.alignment;
  VkDeviceMemory memory =
      device().allocate({second + needs.size, needs.alignment, needs.memoryTypeBits}, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, true);
  {
    gpu::Buffer a(device(), "a", 1000, memory, 0);
    gpu::Buffer b(device(), "b", 1000, memory, second);
    gpu::Buffer alias(device(), "alias of a", 1000, memory, 0);
    EXPECT_EQ(alias.address(), a.address());
    EXPECT_NE(b.address(), a.address());
    gpu::upload(device(), a, std::vector<uint32_t>(250, 1));
    gpu::upload(device(), b, std::vector<uint32_t>(250, 2));
    EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), alias, 250), std::vector<uint32_t>(250, 1));
    EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), b, 250), std::vector<uint32_t>(250, 2));
  }
  device().free(memory);
}

}  // namespace
}  // namespace radivox::tests
