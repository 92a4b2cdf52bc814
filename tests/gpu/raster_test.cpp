// Images, dynamic rendering with and without attachments, geometry shaders, conservative rasterization.
#include <cmath>
#include <cstring>

#include "tests/gpu/devices.h"
#include "tests/gpu/expect_error.h"

namespace radivox::tests {
namespace {

using gpu::BindingType;

struct Point {
  float x, y, z;
};

template <class T>
std::vector<T> readImage(gpu::Device& device, gpu::Image& image, uint32_t layer = 0) {
  const auto raw = gpu::download(device, image, layer);
  std::vector<T> texels(raw.size() / sizeof(T));
  std::memcpy(texels.data(), raw.data(), raw.size());
  return texels;
}

struct Texel {
  float r, g, b, a;
};

class RasterTest : public BothBindingsTest {
 protected:
  static constexpr uint32_t kWidth = 16;
  static constexpr uint32_t kHeight = 12;

  gpu::RasterPipelineInfo describe() const {
    return {.vertexShader = "gpu/test_triangle.vert",
            .fragmentShader = "gpu/test_triangle.frag",
            .bindings = {BindingType::StorageBuffer, BindingType::StorageBuffer},
            .pushConstantBytes = 4};
  }
  gpu::Buffer makePositions(const std::vector<Point>& points) {
    gpu::Buffer buffer(device(), "positions", points.size() * sizeof(Point));
    gpu::upload(device(), buffer, points);
    return buffer;
  }
  std::vector<uint32_t> readHits(const gpu::Buffer& hits) { return gpu::downloadAs<uint32_t>(device(), hits, kWidth * kHeight); }

  // Clip space covers the screen: x right, y down. One triangle over the left half, counter-clockwise as seen.
  const std::vector<Point> leftHalf_ = {{-1, -1, 0.5f}, {-1, 1, 0.5f}, {0, -1, 0.5f}, {0, -1, 0.5f}, {-1, 1, 0.5f}, {0, 1, 0.5f}};
};
INSTANTIATE_TEST_SUITE_P(Bindings, RasterTest, ::testing::Values(true, false), printBinding);

TEST_P(RasterTest, RendersWithoutAttachments) {
  auto info = describe();
  info.constants = {{0, 5}};
  const gpu::Pipeline pipeline(device(), info);
  const gpu::Buffer positions = makePositions(leftHalf_);
  gpu::Buffer hits(device(), "hits", kWidth * kHeight * 4);
  run([&](gpu::Commands& commands) {
    commands.fill(hits, 0);
    commands.barrier();
    commands.beginRendering({kWidth, kHeight}, {}, nullptr);
    commands.bind(pipeline, {positions, hits});
    commands.push(kWidth);
    commands.draw(6);
    commands.endRendering();
    commands.barrier();
  });
  const auto result = readHits(hits);
  for (uint32_t i = 0; i < result.size(); ++i) ASSERT_EQ(result[i], i % kWidth < kWidth / 2 ? 5u : 0u) << "pixel " << i;
}

TEST_P(RasterTest, ColorAndReversedDepth) {
  auto info = describe();
  info.colorFormats = {VK_FORMAT_R32G32B32A32_SFLOAT};
  info.depthFormat = VK_FORMAT_D32_SFLOAT;
  const gpu::Pipeline pipeline(device(), info);
  // Primitive 0 far, over all; 1 near, over the left half; 2 farther still: hidden everywhere.
  std::vector<Point> points = {{-1, -1, 0.25f}, {-1, 3, 0.25f}, {3, -1, 0.25f}};
  const std::vector<Point> nearHalf = {{-1, -1, 0.75f}, {-1, 1, 0.75f}, {0, -1, 0.75f}, {0, -1, 0.75f}, {-1, 1, 0.75f}, {0, 1, 0.75f}};
  points.insert(points.end(), nearHalf.begin(), nearHalf.end());
  for (Point p : {Point{-1, -1, 0.125f}, Point{-1, 3, 0.125f}, Point{3, -1, 0.125f}}) points.push_back(p);
  const gpu::Buffer positions = makePositions(points);
  gpu::Buffer hits(device(), "hits", kWidth * kHeight * 4);
  gpu::Image color(device(), "color", {.width = kWidth, .height = kHeight});
  gpu::Image depth(device(), "depth", {.width = kWidth, .height = kHeight, .layers = 3, .format = VK_FORMAT_D32_SFLOAT});
  run([&](gpu::Commands& commands) {
    commands.fill(hits, 0);
    commands.transition(depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    gpu::Commands::Attachment colorAttachment{&color, 0, true, {}};
    colorAttachment.clearValue.color.float32[2] = -7.f;
    for (uint32_t layer = 0; layer < 3; ++layer) {
      gpu::Commands::Attachment depthAttachment{&depth, layer, true, {}};
      depthAttachment.clearValue.depthStencil.depth = static_cast<float>(layer) * 0.0625f;
      commands.barrier();
      commands.beginRendering({kWidth, kHeight}, {&colorAttachment, 1}, &depthAttachment);
      if (layer == 1) {
        commands.bind(pipeline, {positions, hits});
        commands.push(kWidth);
        commands.draw(static_cast<uint32_t>(points.size()));
      }
      commands.endRendering();
      colorAttachment.clear = layer == 0;  // layer 1 clears, layer 2 keeps what layer 1 drew
    }
    commands.barrier();
  });
  EXPECT_EQ(color.layout, VK_IMAGE_LAYOUT_GENERAL);
  const auto texels = readImage<Texel>(device(), color);
  const auto depths = readImage<float>(device(), depth, 1);
  EXPECT_EQ(depth.layout, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL) << "download must leave the layout as found";
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      const bool left = x < kWidth / 2;
      const Texel texel = texels[y * kWidth + x];
      ASSERT_EQ(depths[y * kWidth + x], left ? 0.75f : 0.25f) << x << ", " << y;
      ASSERT_EQ(texel.r, static_cast<float>(x) + 0.5f);
      ASSERT_EQ(texel.g, static_cast<float>(y) + 0.5f) << "the first row is the top one";
      ASSERT_TRUE(left ? texel.b == 1.f || texel.b == 2.f : texel.b == 0.f) << texel.b;
    }
  }
  EXPECT_EQ(readImage<float>(device(), depth, 0), std::vector<float>(kWidth * kHeight, 0.f));
  EXPECT_EQ(readImage<float>(device(), depth, 2), std::vector<float>(kWidth * kHeight, 0.125f));
  expectError(catchError([&] { gpu::download(device(), depth, 3); }), ErrorCode::BadInput, "layer 3");
}

TEST_P(RasterTest, CullsBackFaces) {
  auto info = describe();
  info.cullMode = VK_CULL_MODE_BACK_BIT;
  const gpu::Pipeline pipeline(device(), info);
  std::vector<Point> turned = leftHalf_;
  std::swap(turned[1], turned[2]);  // the first triangle only
  const gpu::Buffer positions = makePositions(turned);
  gpu::Buffer hits(device(), "hits", kWidth * kHeight * 4);
  run([&](gpu::Commands& commands) {
    commands.fill(hits, 0);
    commands.barrier();
    commands.beginRendering({kWidth, kHeight}, {}, nullptr);
    commands.bind(pipeline, {positions, hits});
    commands.push(kWidth);
    commands.draw(6);
    commands.endRendering();
    commands.barrier();
  });
  const auto result = readHits(hits);
  // Front faces run counter-clockwise as seen on the screen: of the two triangles only the second still does.
  EXPECT_EQ(result[0], 0u);
  EXPECT_EQ(result[(kHeight - 1) * kWidth + kWidth / 2 - 1], 1u);
}

TEST_P(RasterTest, GeometryShader) {
  auto info = describe();
  info.geometryShader = "gpu/test_triangle.geom";
  if (!device().capabilities().geometryShader) {
    expectError(catchError([&] { gpu::Pipeline(device(), info); }), ErrorCode::Unsupported, "geometry");
    GTEST_SKIP() << "no geometry shaders on this device";
  }
  info.colorFormats = {VK_FORMAT_R32G32B32A32_SFLOAT};
  const gpu::Pipeline pipeline(device(), info);
  const gpu::Buffer positions = makePositions(leftHalf_);
  gpu::Buffer hits(device(), "hits", kWidth * kHeight * 4);
  gpu::Image color(device(), "color", {.width = kWidth, .height = kHeight});
  run([&](gpu::Commands& commands) {
    commands.fill(hits, 0);
    gpu::Commands::Attachment attachment{&color, 0, true, {}};
    commands.barrier();
    commands.beginRendering({kWidth, kHeight}, {&attachment, 1}, nullptr);
    commands.bind(pipeline, {positions, hits});
    commands.push(kWidth);
    commands.draw(6);
    commands.endRendering();
    commands.barrier();
  });
  EXPECT_EQ(readHits(hits), std::vector<uint32_t>(kWidth * kHeight, 1)) << "the mirrored copy covers the right half";
  const auto texels = readImage<Texel>(device(), color);
  for (uint32_t i = 0; i < texels.size(); ++i) {
    ASSERT_EQ(static_cast<uint32_t>(texels[i].b) % 2, i % kWidth < kWidth / 2 ? 0u : 1u) << i;
  }
}

TEST_P(RasterTest, ConservativeCoversEveryPixelTouched) {
  auto info = describe();
  info.conservative = true;
  if (!device().capabilities().conservativeRasterization) {
    expectError(catchError([&] { gpu::Pipeline(device(), info); }), ErrorCode::Unsupported, "VK_EXT_conservative_rasterization");
    GTEST_SKIP() << "no conservative rasterization on this device";
  }
  const gpu::Pipeline pipeline(device(), info);
  // A sliver that holds no pixel centre: it lies along the border between two rows' centres.
  const gpu::Buffer positions = makePositions({{-0.9f, -0.01f, 0.5f}, {0.9f, -0.01f, 0.5f}, {0.9f, -0.02f, 0.5f}});
  gpu::Buffer hits(device(), "hits", kWidth * kHeight * 4);
  run([&](gpu::Commands& commands) {
    commands.fill(hits, 0);
    commands.barrier();
    commands.beginRendering({kWidth, kHeight}, {}, nullptr);
    commands.bind(pipeline, {positions, hits});
    commands.push(kWidth);
    commands.draw(3);
    commands.endRendering();
    commands.barrier();
  });
  const auto result = readHits(hits);
  for (uint32_t x = 1; x < kWidth - 1; ++x) EXPECT_EQ(result[(kHeight / 2 - 1) * kWidth + x], 1u) << x;
}

class ImageTest : public oracles::GpuTest {
 protected:
  void clear(gpu::Commands& commands, gpu::Image& image, float value) {
    VkClearColorValue color{};
    for (float& channel : color.float32) channel = value;
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
    vkCmdClearColorImage(commands.handle(), image.handle(), image.layout, &color, 1, &all);
  }
};

TEST_F(ImageTest, DownloadInPiecesAndInAnyLayout) {
  // 2 Mi texels of 16 bytes: as much as one staging buffer; and a row more.
  gpu::Image image(device(), "large", {.width = 2048, .height = 1025});
  for (VkImageLayout layout : {VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL}) {
    run([&](gpu::Commands& commands) {
      commands.transition(image, layout);
      clear(commands, image, 0.5f);
      commands.barrier();
    });
    const auto raw = gpu::download(device(), image);
    ASSERT_EQ(raw.size(), size_t{2048} * 1025 * 16);
    std::vector<float> values(raw.size() / 4);
    std::memcpy(values.data(), raw.data(), raw.size());
    EXPECT_EQ(std::count(values.begin(), values.end(), 0.5f), static_cast<std::ptrdiff_t>(values.size()));
    EXPECT_EQ(image.layout, layout);
  }
  gpu::Image fresh(device(), "fresh", {.width = 4, .height = 4});
  gpu::download(device(), fresh);
  EXPECT_EQ(fresh.layout, VK_IMAGE_LAYOUT_GENERAL);
}

TEST_F(ImageTest, ImagesShareMemoryThatTheCallerOwns) {
  const gpu::ImageInfo info{.width = 50, .height = 20};
  const VkMemoryRequirements needs = gpu::Image::requirements(device(), info);
  EXPECT_GE(needs.size, 50u * 20 * 16);
  VkDeviceMemory memory = device().allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, true);
  {
    gpu::Image first(device(), "first", info, memory, 0);
    gpu::Image second(device(), "second", info, memory, 0);
    run([&](gpu::Commands& commands) {
      commands.transition(first, VK_IMAGE_LAYOUT_GENERAL);
      clear(commands, first, 1.f);
      commands.barrier();
      commands.transition(second, VK_IMAGE_LAYOUT_GENERAL);  // from UNDEFINED: the first's texels are gone
      clear(commands, second, 2.f);
      commands.barrier();
    });
    const auto texels = readImage<Texel>(device(), second);
    EXPECT_EQ(texels.front().a, 2.f);
    EXPECT_EQ(texels.back().r, 2.f);
  }
  device().free(memory);
}

TEST_F(ImageTest, AHostsImageIsUsedAndLeftToIt) {
  gpu::Image owner(device(), "the host's", {.width = 8, .height = 8});
  {
    gpu::Image guest(owner.handle(), owner.view(), owner.info(), VK_IMAGE_LAYOUT_UNDEFINED);
    EXPECT_EQ(guest.layerView(0), owner.view());
    run([&](gpu::Commands& commands) {
      gpu::Commands::Attachment attachment{&guest, 0, true, {}};
      attachment.clearValue.color.float32[0] = 3.f;
      commands.beginRendering({8, 8}, {&attachment, 1}, nullptr);
      commands.endRendering();
      commands.barrier();
    });
    EXPECT_EQ(readImage<Texel>(device(), guest)[63].r, 3.f);
    gpu::Image moved(std::move(guest));
    EXPECT_EQ(moved.layout, VK_IMAGE_LAYOUT_GENERAL);
    EXPECT_FALSE(guest);  // NOLINT: moved-from on purpose
    owner.layout = moved.layout;
  }
  EXPECT_EQ(readImage<Texel>(device(), owner)[0].r, 3.f);
}

TEST_F(ImageTest, EveryFormatOfOursCanBeMade) {
  for (VkFormat format : {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_UINT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM,
                          VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM}) {
    gpu::Image image(device(), "image", {.width = 3, .height = 5, .layers = 2, .format = format});
    EXPECT_EQ(image.aspect() == VK_IMAGE_ASPECT_DEPTH_BIT, gpu::isDepthFormat(format));
    EXPECT_NE(image.layerView(0), image.layerView(1));
    EXPECT_EQ(gpu::download(device(), image, 1).size(), 15u * gpu::texelBytes(format));
  }
  expectError(catchError([&] { gpu::texelBytes(VK_FORMAT_ASTC_4x4_UNORM_BLOCK); }), ErrorCode::BadInput, "format");
}

}  // namespace
}  // namespace radivox::tests
