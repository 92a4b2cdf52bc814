// What a scene does not need is left out, and the picture is the same, bit for bit, with it and without.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
  options.lights.fixed = true;
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

TEST_F(LeftOut, SlowEmitters) {
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  expectSameBits(s, tiny(), Feature::Emitters);
  EXPECT_GT(render(s, tiny(), bit(Feature::Emitters)).bytes, render(s, tiny(), 0).bytes);
}

TEST_F(LeftOut, SlowSky) {
  const scene::Scene s = scene::makeBuiltin("cornell_point");
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    PipelineOptions options = tiny();
    options.graph = graph;
    EXPECT_FALSE(has(render(s, options, 0), "sky"));
    EXPECT_TRUE(has(render(s, options, bit(Feature::Sky)), "sky"));
    expectSameBits(s, options, Feature::Sky);
    // Nor where its light is not passed on.
    scene::Scene lit = s;
    lit.skyRadiance = glm::vec3(1.f);
    EXPECT_TRUE(has(render(lit, options, 0), "sky"));
    options.bounces = 0;
    EXPECT_FALSE(has(render(lit, options, 0), "sky"));
    expectSameBits(lit, options, Feature::Bounces);
  }
}

/// The same scene, lit by one light of that kind alone.
scene::Scene litBy(uint32_t type) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  s.lights.resize(1);
  s.lights[0].type = type;
  s.lights[0].direction = glm::vec3(0.3f, -1.f, 0.2f);
  s.lights[0].innerConeAngle = 0.3f;
  s.lights[0].outerConeAngle = 0.9f;
  return s;
}

TEST_F(LeftOut, SlowOtherLightsThanTheOnlyOne) {
  for (const uint32_t type : {shared::kLightDirectional, shared::kLightPoint, shared::kLightSpot}) {
    SCOPED_TRACE(type);
    const scene::Scene s = litBy(type);
    EXPECT_EQ(s.traits().soleLight(), type);
    const std::vector<float> picture = render(s, tiny(), 0).picture;
    EXPECT_GT(*std::max_element(picture.begin(), picture.end()), 0.f) << "it shines into the room";
    expectSameBits(s, tiny(), Feature::OtherLights);
  }
  scene::Scene two = litBy(shared::kLightPoint);
  two.lights.push_back(two.lights[0]);
  EXPECT_EQ(two.traits().soleLight(), scene::kManyLights);
  EXPECT_EQ(scene::makeBuiltin("cornell").traits().soleLight(), scene::kManyLights) << "its light has an area";
}

// A lamp beside the scene sees it through one of its six views; one that ends before it through none.
TEST_F(LeftOut, SlowShadowMapsWhereNoFaceIs) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  const scene::PunctualLight inside = s.lights[0];
  for (const float range : {0.f, 1.f}) {
    scene::PunctualLight lamp = inside;
    lamp.position = glm::vec3(0.f, 0.f, 30.f);
    lamp.range = range;
    s.lights.push_back(lamp);
  }
  PipelineOptions options = tiny();
  options.lights.pointShadowResolution = 256;
  const scene::Traits traits = scene::traitsFor(s, options.lights);
  EXPECT_EQ(traits.unreachingLightCount, 1u);
  EXPECT_EQ(traits.shadowViewCount, 18u);
  EXPECT_EQ(traits.darkViewCount, 11u);
  for (const char* method : {"splat", "points"}) {
    SCOPED_TRACE(method);
    options.settings.push_back({"inject.method", method});
    expectSameBits(s, options, Feature::DarkViews);
    EXPECT_LT(render(s, options, 0).bytes, render(s, options, bit(Feature::DarkViews)).bytes);
  }
  options.graph = "clustered_voxel_pixels";
  options.settings = tiny().settings;
  EXPECT_EQ(render(s, options, 0).picture, render(s, options, scene::kKeepAll).picture);

  // Where no light reaches a face nothing is lit, and nothing bounces.
  s.lights.erase(s.lights.begin(), s.lights.end() - 1);
  const Outcome without = render(s, tiny(), 0);
  EXPECT_EQ(without.nodes, (std::vector<std::string>{"gbuffer", "composite"}));
  EXPECT_EQ(*std::max_element(without.picture.begin(), without.picture.end()), 0.f);
  expectSameBits(s, tiny(), Feature::DarkViews);
  EXPECT_TRUE(has(render(s, tiny(), bit(Feature::DarkViews)), "shadow_map"));
  // Where lights may move, their maps are all there.
  PipelineOptions moving = tiny();
  moving.lights.fixed = false;
  EXPECT_TRUE(has(render(s, moving, 0), "shadow_map"));
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
  EXPECT_EQ(find("other lights").why, "the only light is a point");
  EXPECT_FALSE(find("other lights").shaders.empty());
  for (const graph::LeftOut& entry : list) {
    EXPECT_NE(entry.what, "punctual lights");
    EXPECT_NE(entry.what, "shadow maps where no face is") << "the lamp is in the middle of the room";
  }
}

// A finer grid than the shapes can use is another picture: the plan advises, and changes nothing.
TEST_F(LeftOut, SlowAFinerGridThanTheShapesNeedIsAdvisedAgainst) {
  const auto adviceAt = [](const std::string& builtin, const char* resolution) {
    PipelineOptions options = tiny();
    options.settings = {{"voxelize.resolution", resolution}};
    Pipeline p(oracles::sharedDevice(), scene::makeBuiltin(builtin), options);
    const graph::Plan& plan = p.executor->plan();
    EXPECT_EQ(plan.printText({}).find("\nadvice\n  voxelize: ") != std::string::npos, !plan.advice.empty());
    EXPECT_EQ(nlohmann::json::parse(plan.printJson({})).at("advice").size(), plan.advice.size());
    return plan.advice.empty() ? "" : plan.advice.front().second;
  };
  // Edges of a unit cube: four voxels from N = 5, eight is the least; 2³ bricks there, 16³ at 64.
  const std::string advice = adviceAt("box", "64");
  EXPECT_NE(advice.find("resolution=64"), std::string::npos) << advice;
  EXPECT_NE(advice.find("at 8 every edge"), std::string::npos) << advice;
  EXPECT_NE(advice.find("8 bricks instead of 4096"), std::string::npos) << advice;
  EXPECT_EQ(adviceAt("box", "9"), "");
  EXPECT_EQ(adviceAt("sphere", "64"), "") << "32 rings have short edges";
}

// What is left out of shadow maps costs what the maps would have been larger by.
TEST_F(LeftOut, TheListSaysWhatMapsWithoutFacesWouldCost) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  s.lights[0].position = glm::vec3(0.f, 0.f, 30.f);
  PipelineOptions options = tiny();
  Pipeline p(oracles::sharedDevice(), s, options);
  const scene::SceneShapes shapes = scene::describeShapes(s, options.lights, options.width, options.height);
  scene::Request request;
  request.width = options.width;
  request.height = options.height;
  const auto list = graph::listLeftOut(
      *p.graph, {scene::traitsFor(s, options.lights), request, device().capabilities(), shapes.imports, shapes.counts}, shapes.counts);
  const auto entry = std::find_if(list.begin(), list.end(), [](const auto& e) { return e.what == "shadow maps where no face is"; });
  ASSERT_NE(entry, list.end());
  EXPECT_EQ(entry->why, "no face is in 5 of 6 views");
  // One tile of 64 texels of 8 bytes; six need a layer of 256.
  EXPECT_EQ(entry->bytes, 8u * (256 * 256 - 64 * 64));
}

}  // namespace
}  // namespace radivox
