// What a scene does not need is left out, and the picture is the same, bit for bit, with it and without.
#include <gtest/gtest.h>

#include "engine/graph/left_out.h"
#include "engine/scene/builtin.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;
using scene::Feature;

constexpr uint32_t bit(Feature feature) { return 1u << static_cast<uint32_t>(feature); }

PipelineOptions tiny() {
  PipelineOptions options;
  options.settings = {{"voxelize.resolution", "12"}, {"visibility.rays", "16"}};
  options.width = 32;
  options.height = 24;
  options.lights = {.shadowResolution = 64, .pointShadowResolution = 64, .emitterSamples = 8, .emitterShadowResolution = 64};
  return options;
}

struct Outcome {
  std::vector<float> picture;
  std::vector<std::string> nodes;
  uint64_t bytes = 0;
};

Outcome render(const scene::Scene& scene, PipelineOptions options, uint32_t kept) {
  options.kept = kept;
  Pipeline p(oracles::sharedDevice(), scene, options);
  p.run();
  Outcome outcome;
  outcome.picture = p.picture("composite.color").data;
  const graph::FrameStats stats = p.executor->stats();
  for (const graph::NodeStats& node : stats.nodes) outcome.nodes.push_back(node.name);
  for (const graph::ResourceStats& resource : stats.resources) outcome.bytes += resource.bytes;
  return outcome;
}

bool has(const Outcome& outcome, const std::string& node) {
  return std::find(outcome.nodes.begin(), outcome.nodes.end(), node) != outcome.nodes.end();
}

class LeftOut : public oracles::GpuTest {
 protected:
  /// Without and with `feature` and with everything: the same picture; keeping it is never cheaper.
  void expectSameBits(const scene::Scene& scene, const PipelineOptions& options, Feature feature) {
    const Outcome without = render(scene, options, 0), with = render(scene, options, bit(feature)),
                  all = render(scene, options, scene::kKeepAll);
    EXPECT_EQ(without.picture, with.picture);
    EXPECT_EQ(without.picture, all.picture);
    EXPECT_GE(with.nodes.size(), without.nodes.size());
    EXPECT_GE(with.bytes, without.bytes);
    EXPECT_GT(all.nodes.size(), without.nodes.size());
    EXPECT_GT(all.bytes, without.bytes);
  }
};

TEST_F(LeftOut, SlowAlphaMasks) { expectSameBits(scene::makeBuiltin("cornell_point"), tiny(), Feature::AlphaMasks); }

TEST_F(LeftOut, SlowTextures) { expectSameBits(scene::makeBuiltin("cornell_point"), tiny(), Feature::Textures); }

TEST_F(LeftOut, SlowSingleSides) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  for (auto& material : s.materials) material.flags |= shared::kMaterialDoubleSided;
  PipelineOptions options = tiny();
  options.settings.push_back({"gbuffer.sides", "gltf"});
  options.settings.push_back({"shadow_map.sides", "gltf"});
  expectSameBits(s, options, Feature::SingleSides);
}

TEST_F(LeftOut, SlowPunctualLights) { expectSameBits(scene::makeBuiltin("cornell"), tiny(), Feature::PunctualLights); }

TEST_F(LeftOut, Emitters) {
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  expectSameBits(s, tiny(), Feature::Emitters);
  EXPECT_GT(render(s, tiny(), bit(Feature::Emitters)).bytes, render(s, tiny(), 0).bytes);
}

TEST_F(LeftOut, SlowMatrixOfOneBounce) {
  PipelineOptions options = tiny();
  options.bounces = 1;
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  expectSameBits(s, options, Feature::Matrix);
  EXPECT_FALSE(has(render(s, options, 0), "transfer"));
  EXPECT_TRUE(has(render(s, options, bit(Feature::Matrix)), "transfer"));
}

TEST_F(LeftOut, SlowPicturesThatNobodyAskedFor) {
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  expectSameBits(s, tiny(), Feature::Readers);
  EXPECT_FALSE(has(render(s, tiny(), 0), "inspect"));
  EXPECT_TRUE(has(render(s, tiny(), bit(Feature::Readers)), "inspect"));
}

// Nothing to bounce: no more than direct light, for each reason that there is.
TEST_F(LeftOut, SlowIndirectLight) {
  scene::Scene black = scene::makeBuiltin("cornell_point"), dark = black;
  for (auto& material : black.materials) material.albedo = glm::vec3(0.f);
  dark.lights.clear();
  const scene::Scene flat = scene::makeBuiltin("plane");
  PipelineOptions none = tiny();
  none.bounces = 0;
  struct Case {
    const char* what;
    const scene::Scene* scene;
    PipelineOptions options;
  };
  const scene::Scene lit = scene::makeBuiltin("cornell_point");
  const Case cases[] = {{"black", &black, tiny()}, {"dark", &dark, tiny()}, {"flat", &flat, tiny()}, {"0 bounces", &lit, none}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const Outcome without = render(*c.scene, c.options, 0);
    EXPECT_FALSE(has(without, "voxelize"));
    EXPECT_TRUE(has(render(*c.scene, c.options, bit(Feature::Bounces)), "gather"));
    expectSameBits(*c.scene, c.options, Feature::Bounces);
    PipelineOptions direct = c.options;
    direct.graph = "direct";
    direct.settings.clear();
    const Outcome only = render(*c.scene, direct, 0);
    EXPECT_EQ(only.picture, without.picture);
    EXPECT_EQ(only.nodes, without.nodes);
    EXPECT_EQ(only.bytes, without.bytes);
  }
  // Sky light needs the rays even there.
  scene::Scene sky = flat;
  sky.skyRadiance = glm::vec3(1.f);
  EXPECT_TRUE(has(render(sky, tiny(), 0), "gather"));
}

TEST_F(LeftOut, SlowThePixelReceiverToo) {
  PipelineOptions options = tiny();
  options.graph = "clustered_voxel_pixels";
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  EXPECT_EQ(render(s, options, 0).picture, render(s, options, scene::kKeepAll).picture);
}

TEST_F(LeftOut, TheListSaysWhyAndWhatItWouldCost) {
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  PipelineOptions options = tiny();
  options.bounces = 1;
  Pipeline p(oracles::sharedDevice(), s, options);
  const scene::SceneShapes shapes = scene::describeShapes(s, options.lights, options.width, options.height);
  const scene::Traits traits = scene::traitsFor(s, options.lights);
  scene::Request request;
  request.width = options.width;
  request.height = options.height;
  request.bounces = 1;
  const auto list = graph::listLeftOut(*p.graph, {traits, request, device().capabilities(), shapes.imports, shapes.counts}, shapes.counts);
  const auto find = [&](const std::string& what) {
    for (const graph::LeftOut& entry : list) {
      if (entry.what == what) return entry;
    }
    ADD_FAILURE() << what;
    return graph::LeftOut{};
  };
  EXPECT_EQ(find("light between clusters").nodes, std::vector<std::string>{"transfer"});
  EXPECT_EQ(find("light between clusters").why, "one bounce is asked for");
  EXPECT_TRUE(find("light between clusters").open) << "how large the matrix is only a run tells";
  EXPECT_EQ(find("alpha masks").why, "no material has one");
  EXPECT_FALSE(find("alpha masks").shaders.empty());
  // Two pictures of 32 × 24 pixels of 16 bytes that inspect would make, and more.
  EXPECT_GE(find("pictures").bytes, 2u * 32 * 24 * 16);
  for (const graph::LeftOut& entry : list) EXPECT_NE(entry.what, "punctual lights");
}

}  // namespace
}  // namespace radivox
