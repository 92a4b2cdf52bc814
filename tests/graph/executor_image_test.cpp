// Layouts and barriers of images: storage, attachments, depth read by shaders, shared scratch, a host's images.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/graph/gpu_nodes.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::RecordContext;
using graph::Shape;

class ExecutorImageTest : public GpuTest {};

constexpr uint32_t kSide = 16;
const Shape kTexels = Shape::image(VK_FORMAT_R32_UINT, kSide, kSide);

struct TexelPipeline {
  gpu::Pipeline pipeline;
  void prepare(gpu::Device& device) {
    pipeline = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "graph/test_texels.comp",
                                                              .bindings = {gpu::BindingType::StorageImage, gpu::BindingType::StorageImage},
                                                              .pushConstantBytes = 4});
  }
  void dispatch(gpu::Commands& commands, const gpu::Image& source, const gpu::Image& target, uint32_t amount) const {
    commands.bind(pipeline, {source, target});
    commands.push(amount);
    commands.dispatch((target.info().width + 7) / 8, (target.info().height + 7) / 8);
  }
};

/// out = in + value through a scratch image.
FakeNode& addTexels(graph::Graph& graph, const std::string& name) {
  const auto add = std::make_shared<TexelPipeline>();
  FakeNode& node = addFake(graph, name, [](Declaration& d) {
    d.read("in", "texels").kind = graph::ResourceKind::Image;
    d.scratch("temporary", kTexels, "texels", graph::UseCompute);
    d.write("out", kTexels, "texels", graph::UseCompute);
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add, &node](RecordContext& c) {
    add->dispatch(c.commands(), c.image("in"), c.image("temporary"), node.value);
    c.commands().barrier();
    add->dispatch(c.commands(), c.image("temporary"), c.image("out"), 0);
  };
  return node;
}

TEST_F(ExecutorImageTest, StorageImagesThroughSharedScratch) {
  NodeHarness h(device());
  std::vector<uint32_t> texels(kSide * kSide);
  std::iota(texels.begin(), texels.end(), 1000u);
  h.importImage("in.picture", {kSide, kSide, 1, VK_FORMAT_R32_UINT}, texels);
  std::string last = "in.picture";
  for (const char* name : {"a", "b", "c"}) {
    addTexels(h.graph(), name);
    h.connect(last, std::string(name) + ".in");
    last = std::string(name) + ".out";
  }
  h.output("a.out");
  h.output("c.out");
  h.set("b.value", "10");
  h.run();
  auto expected = texels;
  for (uint32_t& t : expected) t += 12;
  EXPECT_EQ(h.downloadImage<uint32_t>("c.out"), expected);
  h.set("b.value", "20");  // only b and c run; their scratch and outputs are in use already
  h.run();
  for (uint32_t& t : expected) t += 10;
  EXPECT_EQ(h.downloadImage<uint32_t>("c.out"), expected);
  EXPECT_EQ(h.runCount("a"), 1u);
}

TEST_F(ExecutorImageTest, AttachmentsAndDepthReadByShaders) {
  //  draw clears colour and depth as attachments ──▶ read (compute: sampler on depth)
  NodeHarness h(device());
  FakeNode& draw = addFake(h.graph(), "draw", [](Declaration& d) {
    d.write("color", kTexels, "texels", graph::UseAttachment);
    d.write("depth", Shape::image(VK_FORMAT_D32_SFLOAT, kSide, kSide), "depth", graph::UseAttachment);
  });
  draw.onRecord = [&draw](RecordContext& c) {
    gpu::Commands::Attachment color{&c.image("color"), 0, true, {}};
    color.clearValue.color.uint32[0] = draw.value;
    gpu::Commands::Attachment depth{&c.image("depth"), 0, true, {}};
    depth.clearValue.depthStencil.depth = static_cast<float>(draw.value) / 8.f;
    c.commands().beginRendering({kSide, kSide}, std::span(&color, 1), &depth);
    c.commands().endRendering();
  };
  const auto pipeline = std::make_shared<gpu::Pipeline>();
  FakeNode& read = addFake(h.graph(), "read", [](Declaration& d) {
    d.read("depth", "depth");
    d.write("out", Shape::buffer(4, kSide * kSide), "depths", graph::UseCompute);
  });
  read.onPrepare = [pipeline](graph::PrepareContext& c) {
    *pipeline =
        gpu::Pipeline(c.device(), gpu::ComputePipelineInfo{.shader = "graph/test_depth.comp",
                                                           .bindings = {gpu::BindingType::SampledImage, gpu::BindingType::StorageBuffer}});
  };
  read.onRecord = [pipeline](RecordContext& c) {
    EXPECT_EQ(c.image("depth").layout, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL);
    c.commands().bind(*pipeline, {c.image("depth"), c.buffer("out")});
    c.commands().dispatchItems(kSide * kSide, 64);
  };
  addTexels(h.graph(), "after");
  h.connect("draw.depth", "read.depth");
  h.connect("draw.color", "after.in");
  h.output("read.out");
  h.output("after.out");
  for (const uint32_t value : {4u, 6u}) {  // the second time depth comes back from the shader's layout
    h.set("draw.value", std::to_string(value));
    h.run();
    EXPECT_EQ(h.download<float>("read.out"), std::vector<float>(kSide * kSide, static_cast<float>(value) / 8.f));
    EXPECT_EQ(h.downloadImage<uint32_t>("after.out"), repeat(kSide * kSide, value + 1));
  }
}

TEST_F(ExecutorImageTest, AHostsImageIsModifiedInItsOwnLayout) {
  //  host image (in TRANSFER_SRC_OPTIMAL, say) ──▶ overlay modifies it
  gpu::Image picture(device(), "host picture", {kSide, kSide, 1, VK_FORMAT_R32_UINT});
  runCommands(device(), [&](gpu::Commands& commands) {
    commands.transition(picture, VK_IMAGE_LAYOUT_GENERAL);
    const VkClearColorValue value{.uint32 = {40, 0, 0, 0}};
    const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), picture.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &range);
    commands.transition(picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  });
  const auto add = std::make_shared<TexelPipeline>();
  NodeHarness h(device());
  h.importImage("host.picture", picture);
  FakeNode& node = addFake(h.graph(), "overlay", [](Declaration& d) { d.modify("picture", "texels"); });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add](RecordContext& c) { add->dispatch(c.commands(), c.image("picture"), c.image("picture"), 2); };
  h.connect("host.picture", "overlay.picture");
  h.output("overlay.picture");
  h.run();
  EXPECT_EQ(picture.layout, VK_IMAGE_LAYOUT_GENERAL);
  EXPECT_EQ(&h.image("overlay.picture"), &picture);
  EXPECT_EQ(h.downloadImage<uint32_t>("overlay.picture"), repeat(kSide * kSide, 42));
}

TEST_F(ExecutorImageTest, ArrayLayersAndSizesFromCounts) {
  NodeHarness h(device());
  h.setCount("views", 3);
  addFake(
      h.graph(), "node",
      [](Declaration& d) {
        d.write("maps", Shape::image(VK_FORMAT_R32_UINT, 4, 4, graph::Extent::of("views"), true), "texels", graph::UseAttachment);
        d.write("none", Shape::image(VK_FORMAT_R32_UINT, graph::Extent::of("nothing"), 4), "texels", graph::UseAttachment);
      },
      [](RecordContext& c) {
        for (uint32_t layer = 0; layer < c.image("maps").info().layers; ++layer) {
          gpu::Commands::Attachment target{&c.image("maps"), layer, true, {}};
          target.clearValue.color.uint32[0] = layer + 7;
          c.commands().beginRendering({4, 4}, std::span(&target, 1), nullptr);
          c.commands().endRendering();
        }
      });
  h.setCount("nothing", 0);
  h.output("node.maps");
  h.run();
  for (uint32_t layer = 0; layer < 3; ++layer) EXPECT_EQ(h.downloadImage<uint32_t>("node.maps", layer), repeat(16, layer + 7));
  EXPECT_EQ(h.image("node.none").info().width, 1u) << "an image is at least one texel wide";
}

}  // namespace
}  // namespace radivox::oracles
