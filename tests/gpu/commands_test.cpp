// Bindings of every kind, null ones, dispatch folding, indirect dispatch, timestamps, shader lookup, pipeline errors.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "engine/gpu/scan.h"
#include "engine/gpu/timestamps.h"
#include "tests/gpu/devices.h"
#include "tests/gpu/expect_error.h"

namespace radivox::tests {
namespace {

using gpu::BindingType;

gpu::Pipeline makeItemsPipeline(gpu::Device& device, bool throughList) {
  return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "gpu/test_items.comp",
                                                        .bindings = std::vector(3, BindingType::StorageBuffer),
                                                        .constants = {{0, throughList ? 1u : 0u}}});
}

class CommandsTest : public BothBindingsTest {};
INSTANTIATE_TEST_SUITE_P(Bindings, CommandsTest, ::testing::Values(true, false), printBinding);

TEST_P(CommandsTest, DispatchItemsVisitsEachItemOnceAcrossRows) {
  const gpu::Pipeline pipeline = makeItemsPipeline(device(), false);
  const uint32_t row = gpu::Commands::kMaxGroupsX * 64;
  for (uint32_t itemCount : {0u, 1u, 64u, 65u, row, row + 1, 2 * row + 17}) {
    gpu::Buffer visits(device(), "visits", (itemCount + 64) * 4);
    gpu::Buffer count(device(), "count", 4);
    run([&](gpu::Commands& commands) {
      commands.fill(visits, 0);
      commands.update(count, &itemCount, 4);
      commands.barrier();
      commands.bind(pipeline, {visits, gpu::Buffer(), count});
      commands.dispatchItems(itemCount, 64);
    });
    const auto result = gpu::downloadAs<uint32_t>(device(), visits, itemCount + 64);
    for (uint32_t i = 0; i < result.size(); ++i) ASSERT_EQ(result[i], i < itemCount ? 1u : 0u) << i << " of " << itemCount;
  }
}

TEST_P(CommandsTest, CompactionFeedsIndirectDispatch) {
  const gpu::Pipeline pipeline = makeItemsPipeline(device(), true);
  const gpu::Scan scan(device());
  constexpr uint32_t kItems = 3000000;  // all set: more groups than one row holds
  for (uint32_t word : {0u, 0x80000001u, ~0u}) {
    gpu::Buffer bits(device(), "bits", kItems / 8);
    gpu::Buffer list(device(), "list", kItems * 4);
    gpu::Buffer count(device(), "count", 16);
    gpu::Buffer visits(device(), "visits", kItems * 4);
    gpu::Buffer scratch(device(), "scratch", gpu::Scan::compactScratchBytes(kItems));
    run([&](gpu::Commands& commands) {
      commands.fill(bits, word);
      commands.fill(visits, 0);
      scan.compactBits(commands, bits, kItems, list, count, 64, scratch);
      commands.bind(pipeline, {visits, list, count});
      commands.dispatchIndirect(count, 4);
    });
    const auto result = gpu::downloadAs<uint32_t>(device(), visits, kItems);
    for (uint32_t i = 0; i < kItems; ++i) ASSERT_EQ(result[i], word >> (i % 32) & 1u) << i;
  }
}

struct BindingsPush {
  uint32_t present, width, height;
};

TEST_P(CommandsTest, BindsEveryKindAndNulls) {
  constexpr uint32_t kWidth = 13;
  constexpr uint32_t kHeight = 9;
  const gpu::Pipeline pipeline(
      device(), gpu::ComputePipelineInfo{
                    .shader = "gpu/test_bindings.comp",
                    .bindings = {BindingType::StorageBuffer, BindingType::StorageBuffer, BindingType::UniformBuffer,
                                 BindingType::StorageImage, BindingType::StorageImage, BindingType::SampledImage, BindingType::SampledImage,
                                 BindingType::SampledImage, BindingType::StorageImage, BindingType::SampledImage,
                                 // Texel buffers, since the shader says so.
                                 BindingType::StorageBuffer, BindingType::StorageBuffer},
                    .pushConstantBytes = sizeof(BindingsPush)});
  gpu::Buffer out(device(), "out", kWidth * kHeight * 4);
  gpu::Buffer words(device(), "words", 256 + kWidth * 4);
  gpu::Buffer constants(device(), "constants", 512);
  std::vector<uint32_t> wordData(words.bytes() / 4, 0);
  for (uint32_t x = 0; x < kWidth; ++x) wordData[64 + x] = x * 3;
  gpu::upload(device(), words, wordData);
  std::vector<uint32_t> constantData(128, 0);
  constantData[65] = 1000;  // .y at offset 256
  gpu::upload(device(), constants, constantData);
  EXPECT_EQ(pipeline.bindings()[10], BindingType::TexelBuffer);
  EXPECT_EQ(pipeline.bindings()[11], BindingType::TexelBuffer);
  gpu::Buffer vectors(device(), "vectors", kHeight * 16 + 4);  // the last word is no whole texel
  std::vector<float> vectorData(vectors.bytes() / 4, -1.f);
  for (uint32_t y = 0; y < kHeight; ++y) vectorData[4 * y + 3] = static_cast<float>(50000000 + 4 * y);
  gpu::upload(device(), vectors, vectorData);
  gpu::Image color(device(), "color", {.width = kWidth, .height = kHeight});
  gpu::Image layers(device(), "layers", {.width = kWidth, .height = kHeight, .layers = 2, .format = VK_FORMAT_R32_UINT});
  gpu::Image depth(device(), "depth", {.width = kWidth, .height = kHeight, .format = VK_FORMAT_D32_SFLOAT});
  gpu::Image integers(device(), "integers", {.width = kWidth, .height = kHeight, .format = VK_FORMAT_R32_SINT});

  const gpu::BoundResource shownWords(words, 256, kWidth * 4);
  const gpu::BoundResource shownConstants(constants, 256, 256);
  const gpu::Buffer noBuffer;
  const gpu::Image noImage;
  // What each bit of `present` adds to every result, apart from bits 1 and 10, which add 3x, and 11, which adds 50000000 + 4y.
  const uint32_t adds[10] = {0, 0, 1000, 20000, 300000, 20000, 300000, 512, 4000000, 4000000};
  for (uint32_t present : {0xffeu, 0x0u, 0x2u, 0x4u, 0x8u, 0x10u, 0x20u, 0x40u, 0x80u, 0x100u, 0x200u, 0x400u, 0x800u}) {
    auto has = [&](uint32_t bit) { return (present >> bit & 1u) != 0; };
    run([&](gpu::Commands& commands) {
      commands.transition(color, VK_IMAGE_LAYOUT_GENERAL);
      commands.transition(layers, VK_IMAGE_LAYOUT_GENERAL);
      commands.transition(integers, VK_IMAGE_LAYOUT_GENERAL);
      VkClearColorValue value{};
      const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
      value.float32[2] = 20000.f;
      vkCmdClearColorImage(commands.handle(), color.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
      value.uint32[0] = 300000;
      vkCmdClearColorImage(commands.handle(), layers.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
      value.int32[0] = 4000000;
      vkCmdClearColorImage(commands.handle(), integers.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
      gpu::Commands::Attachment attachment{&depth, 0, true, {}};
      attachment.clearValue.depthStencil.depth = 0.5f;
      commands.beginRendering({kWidth, kHeight}, {}, &attachment);
      commands.endRendering();
      commands.transition(depth, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL);
      commands.barrier();
      const gpu::BoundResource resources[] = {out,
                                              has(1) ? shownWords : gpu::BoundResource(noBuffer),
                                              has(2) ? shownConstants : gpu::BoundResource(noBuffer),
                                              has(3) ? color : noImage,
                                              has(4) ? layers : noImage,
                                              has(5) ? color : noImage,
                                              has(6) ? layers : noImage,
                                              has(7) ? depth : noImage,
                                              has(8) ? integers : noImage,
                                              has(9) ? integers : noImage,
                                              has(10) ? words : noBuffer,
                                              has(11) ? vectors : noBuffer};
      commands.bind(pipeline, resources);
      commands.push(BindingsPush{present, kWidth, kHeight});
      commands.dispatch(2, 2);
      commands.barrier();
    });
    const auto result = gpu::downloadAs<uint32_t>(device(), out, kWidth * kHeight);
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        uint32_t expected = (has(1) ? x * 3 : 0) + (has(10) ? x * 3 : 0) + (has(11) ? 50000000 + 4 * y : 0);
        for (uint32_t bit = 2; bit < 10; ++bit) expected += has(bit) ? adds[bit] : 0;
        ASSERT_EQ(result[y * kWidth + x], expected) << "present " << present << " at " << x << ", " << y;
      }
    }
  }
}

// More sets than one pool of the fallback holds, and again after reset().
TEST_P(CommandsTest, ManyBindingsInOneCommandBuffer) {
  const gpu::Pipeline pipeline = makeItemsPipeline(device(), false);
  gpu::Buffer visits(device(), "visits", 64);
  gpu::Buffer count(device(), "count", 4);
  gpu::upload(device(), count, std::vector<uint32_t>{1});
  gpu::DescriptorPool pool(device());
  for (uint32_t round = 1; round <= 2; ++round) {
    device().submitAndWait([&](VkCommandBuffer handle) {
      gpu::Commands commands(device(), handle, pool);
      if (round == 1) commands.fill(visits, 0);
      commands.barrier();
      for (int i = 0; i < 3000; ++i) {
        commands.bind(pipeline, {visits, gpu::Buffer(), count});
        commands.dispatch(1);
        commands.barrier();
      }
    });
    pool.reset();
    EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), visits, 1)[0], 3000 * round);
  }
}

TEST_P(CommandsTest, FillUpdateCopy) {
  gpu::Buffer a(device(), "a", 64);
  gpu::Buffer b(device(), "b", 64);
  const uint32_t words[2] = {7, 8};
  run([&](gpu::Commands& commands) {
    commands.fill(a, 1);
    commands.fill(b, 2);
    commands.barrier();
    commands.fill(a, 3, 8, 4);
    commands.update(a, words, 8, 16);
    commands.fill(a, 9, 0, 0);
    commands.barrier();
    commands.copy(a, b, 20, 8, 4);
    commands.copy(a, b, 0);
    commands.barrier();
  });
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), a, 8), (std::vector<uint32_t>{1, 1, 3, 1, 7, 8, 1, 1}));
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), b, 8), (std::vector<uint32_t>{2, 3, 1, 7, 8, 1, 2, 2}));
}

class TimestampsTest : public oracles::GpuTest {};

TEST_F(TimestampsTest, MeasureWorkInOrder) {
  gpu::Timestamps times(device(), 4);
  ASSERT_EQ(times.isActive(), device().capabilities().timestampPeriodNs > 0.f);
  if (!times.isActive()) GTEST_SKIP() << "no timestamps on this device";
  gpu::Buffer buffer(device(), "buffer", 64 << 20);
  for (bool fromHost : {true, false}) {
    if (fromHost) times.reset();
    run([&](gpu::Commands& commands) {
      if (!fromHost) times.reset(commands.handle());
      times.write(commands.handle(), 0);
      for (uint32_t i = 0; i < 4; ++i) {
        commands.fill(buffer, i);
        commands.barrier();
      }
      times.write(commands.handle(), 1);
      times.write(commands.handle(), 2);
    });
    const auto ns = times.readNs(0, 4);
    EXPECT_EQ(ns[0], 0.0);
    EXPECT_GT(ns[1], 256e6 / 20e12 * 1e9) << "256 MB cannot be written faster than 20 TB/s";
    EXPECT_LT(ns[1], 20e9);
    EXPECT_GE(ns[2], ns[1]);
    EXPECT_EQ(ns[3], 0.0) << "never written";
  }
}

TEST_F(TimestampsTest, WithoutQueriesReadZero) {
  const gpu::Timestamps none;
  EXPECT_FALSE(none.isActive());
  gpu::Timestamps empty(device(), 0);
  EXPECT_FALSE(empty.isActive());
  EXPECT_TRUE(empty.readNs(0, 0).empty());
  gpu::Timestamps some(device(), 2);
  EXPECT_EQ(some.readNs(0, 2), std::vector<double>(2, 0.0));
  gpu::Timestamps moved(std::move(some));
  EXPECT_EQ(moved.capacity(), 2u);
  EXPECT_FALSE(some.isActive());  // NOLINT: moved-from on purpose
}

class PipelineTest : public oracles::GpuTest {};

TEST_F(PipelineTest, ErrorsNameTheShader) {
  expectError(catchError([&] { gpu::findShader("gpu/nothing.comp"); }), ErrorCode::BadInput, "gpu/nothing.comp");
  expectError(catchError([&] { gpu::Pipeline(device(), gpu::ComputePipelineInfo{.shader = "gpu/nothing.comp"}); }), ErrorCode::BadInput,
              "pipeline gpu/nothing.comp");
  expectError(
      catchError([&] { gpu::Pipeline(device(), gpu::ComputePipelineInfo{.shader = "gpu/test_items.comp", .pushConstantBytes = 132}); }),
      ErrorCode::Unsupported, "128");
  expectError(catchError([&] {
                gpu::Pipeline(device(), gpu::ComputePipelineInfo{.shader = "gpu/test_items.comp",
                                                                 .bindings = std::vector(33, BindingType::StorageBuffer)});
              }),
              ErrorCode::Unsupported, "32");
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device().physicalDevice(), &properties);
  const uint32_t uniforms = properties.limits.maxPerStageDescriptorUniformBuffers + 1;
  if (uniforms <= gpu::kMaxBindings) {
    expectError(catchError([&] {
                  gpu::Pipeline(device(), gpu::ComputePipelineInfo{.shader = "gpu/test_items.comp",
                                                                   .bindings = std::vector(uniforms, BindingType::UniformBuffer)});
                }),
                ErrorCode::Unsupported, "uniform buffers");
  }
}

TEST_F(PipelineTest, TexelsOfBuffersEndAtTheDevicesLimit) {
  const gpu::Buffer buffer(device(), "a buffer", 100);
  EXPECT_EQ(buffer.texels(gpu::TexelType::Uint), buffer.texels(gpu::TexelType::Uint)) << "one view";
  EXPECT_NE(buffer.texels(gpu::TexelType::Uint), buffer.texels(gpu::TexelType::Float));
  EXPECT_NE(buffer.texels(gpu::TexelType::Int), buffer.texels(gpu::TexelType::Uint));
  const uint64_t most = device().capabilities().maxTexelBufferElements;
  ASSERT_GT(most, 0u);
  if (4 * (most + 1) <= uint64_t{1} << 30) {
    const gpu::Buffer large(device(), "a large buffer", 4 * (most + 1));
    expectError(catchError([&] { large.texels(gpu::TexelType::Uint); }), ErrorCode::OutOfMemory, "buffer a large buffer");
    EXPECT_NE(large.texels(gpu::TexelType::Float), VkBufferView{VK_NULL_HANDLE});
  }
  const gpu::Buffer hosts("a host's", buffer.handle(), buffer.bytes(), 0);
  expectError(catchError([&] { hosts.texels(gpu::TexelType::Uint); }), ErrorCode::Unsupported, "a host's");
}

TEST_F(PipelineTest, ManyAreCompiledAtOnceAndWaitedFor) {
  std::vector<gpu::Pipeline> pipelines;
  for (uint32_t i = 0; i < 24; ++i) pipelines.push_back(makeItemsPipeline(device(), i % 2 == 1));
  EXPECT_TRUE(pipelines.back()) << "asked for is as good as there";
  pipelines.erase(pipelines.begin(), pipelines.begin() + 8);  // some before they may be done
  device().waitForPipelines();
  const gpu::Pipeline moved = std::move(pipelines.front());
  EXPECT_NE(moved.handle(), VkPipeline{VK_NULL_HANDLE});
  std::set<VkPipeline> handles;
  for (size_t i = 1; i < pipelines.size(); ++i) handles.insert(pipelines[i].handle());
  EXPECT_EQ(handles.size(), pipelines.size() - 1);
}

TEST_F(PipelineTest, TakesCodeFromElsewhere) {
  const auto code = gpu::findShader("gpu/test_items.comp");
  const gpu::Pipeline pipeline(
      device(),
      gpu::ComputePipelineInfo{.shader = "a plugin's shader", .code = code, .bindings = std::vector(3, BindingType::StorageBuffer)});
  EXPECT_TRUE(pipeline);
  EXPECT_EQ(pipeline.bindPoint(), VK_PIPELINE_BIND_POINT_COMPUTE);
}

TEST_F(PipelineTest, ShadersAreFoundOnDiskFirst) {
  const auto folder = std::filesystem::temp_directory_path() / ("radivox_shader_test_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder / "gpu");
  const auto embedded = gpu::findShader("gpu/test_items.comp");
  std::ofstream(folder / "gpu" / "other.comp.spv", std::ios::binary)
      .write(reinterpret_cast<const char*>(embedded.data()), static_cast<std::streamsize>(embedded.size_bytes()));
  std::ofstream(folder / "gpu" / "bad.comp.spv", std::ios::binary) << "this is not SPIR-V, whatever its name";
  ::setenv("RADIVOX_SHADER_DIR", folder.c_str(), 1);
  const auto found = gpu::findShader("gpu/other.comp");
  EXPECT_TRUE(std::equal(found.begin(), found.end(), embedded.begin(), embedded.end()));
  EXPECT_EQ(gpu::findShader("gpu/test_items.comp").data(), embedded.data()) << "what is not on disk is still built in";
  expectError(catchError([&] { gpu::findShader("gpu/bad.comp"); }), ErrorCode::BadInput, "bad.comp.spv");
  ::unsetenv("RADIVOX_SHADER_DIR");
  expectError(catchError([&] { gpu::findShader("gpu/other.comp"); }), ErrorCode::BadInput, "gpu/other.comp");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace radivox::tests
