// Composite's arithmetic on given images, and what it leaves out.
#include <gtest/gtest.h>

#include <numbers>

#include "modules/frame/composite.h"
#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox {
namespace {

using frame_test::FrameOptions;
using frame_test::FrameRun;
using frame_test::SceneBuilder;

constexpr float kPi = std::numbers::pi_v<float>;

scene::Traits skyTraits() {
  scene::Traits traits;
  traits.sky = true;
  return traits;
}

scene::Request requestOf(uint32_t bounces) {
  scene::Request request;
  request.width = 4;
  request.height = 1;
  request.bounces = bounces;
  return request;
}

/// A composite alone on given images. Pixels: 0 surface, 1 sky, 2 emitter, 3 black surface.
struct Bench {
  Bench(gpu::Device& device, uint32_t bounces, bool withDirect, bool withIndirect) : harness(device, skyTraits(), requestOf(bounces)) {
    harness.setCount("width", 4);
    harness.setCount("height", 1);
    harness.add<frame::Composite>("composite");
    const auto give = [&](const std::string& port, const std::vector<glm::vec4>& pixels) {
      harness.importImage("in." + port, {.width = 4, .height = 1}, pixels);
      harness.connect("in." + port, "composite." + port);
    };
    give("albedo", {{0.2f, 0.4f, 0.8f, 1.f}, {0.f, 0.f, 0.f, 0.f}, {0.5f, 0.5f, 0.5f, 1.f}, {0.f, 0.f, 0.f, 1.f}});
    give("emission", {{0.f, 0.f, 0.f, 0.f}, {0.f, 0.f, 0.f, 0.f}, {7.f, 8.f, 9.f, 0.f}, {0.f, 0.f, 0.f, 0.f}});
    if (withDirect) give("irradiance", {{1.f, 2.f, 3.f, 1.f}, {0.f, 0.f, 0.f, 0.f}, {1.f, 1.f, 1.f, 1.f}, {5.f, 5.f, 5.f, 1.f}});
    if (withIndirect) give("indirect", {{4.f, 5.f, 6.f, 0.25f}, {9.f, 9.f, 9.f, 1.f}, {0.f, 0.f, 0.f, 1.f}, {5.f, 5.f, 5.f, 0.5f}});
    shared::SceneInfo info{};
    info.skyRadiance = {0.1f, 0.2f, 0.3f};
    harness.importValue("scene.info", info);
    for (const char* port : {"color", "direct", "indirect_radiance", "irradiance_direct"}) harness.output(std::string("composite.") + port);
    harness.run();
  }
  std::vector<glm::vec4> pixels(const std::string& port) { return harness.downloadImage<glm::vec4>("composite." + port); }
  oracles::NodeHarness harness;
};

class CompositeTest : public oracles::GpuTest {};

void expectNear(const glm::vec4& value, const glm::vec3& expected) {
  EXPECT_LT(glm::length(glm::vec3(value) - expected), 1e-5f)
      << value.x << ", " << value.y << ", " << value.z << " not " << expected.x << ", " << expected.y << ", " << expected.z;
}

TEST_F(CompositeTest, AddsUp) {
  Bench bench(device(), scene::kAllBounces, true, true);
  const glm::vec3 sky(0.1f, 0.2f, 0.3f), rho(0.2f, 0.4f, 0.8f);
  const glm::vec3 direct = glm::vec3(1.f, 2.f, 3.f) + kPi * 0.25f * sky, indirect(4.f, 5.f, 6.f);
  const auto color = bench.pixels("color"), outDirect = bench.pixels("direct"), outIndirect = bench.pixels("indirect_radiance"),
             irradiance = bench.pixels("irradiance_direct");
  expectNear(color[0], rho * (direct + indirect) / kPi);
  expectNear(outDirect[0], rho * direct / kPi);
  expectNear(outIndirect[0], rho * indirect / kPi);
  expectNear(irradiance[0], direct);
  expectNear(color[1], sky);
  expectNear(irradiance[1], glm::vec3(0.f));
  EXPECT_EQ(color[0].a, 1.f);
  EXPECT_EQ(color[1].a, 0.f);
  expectNear(color[2], glm::vec3(7.f, 8.f, 9.f) + 0.5f / kPi * (glm::vec3(1.f) + kPi * sky));
  expectNear(color[3], glm::vec3(0.f));
}

TEST_F(CompositeTest, ZeroBouncesKeepOnlySkyVisibility) {
  Bench bench(device(), 0, true, true);
  expectNear(bench.pixels("irradiance_direct")[0], glm::vec3(1.f, 2.f, 3.f) + kPi * 0.25f * glm::vec3(0.1f, 0.2f, 0.3f));
  expectNear(bench.pixels("indirect_radiance")[0], glm::vec3(0.f));
}

TEST_F(CompositeTest, AbsentInputsAreDark) {
  Bench bench(device(), scene::kAllBounces, false, false);
  expectNear(bench.pixels("color")[0], glm::vec3(0.f));
  expectNear(bench.pixels("color")[1], glm::vec3(0.1f, 0.2f, 0.3f));
  expectNear(bench.pixels("color")[2], glm::vec3(7.f, 8.f, 9.f));
}

TEST_F(CompositeTest, IndirectIsUnwantedOnlyWithoutBouncesAndSky) {
  for (const bool sky : {false, true}) {
    for (const uint32_t bounces : {0u, 1u}) {
      scene::Traits traits;
      traits.sky = sky;
      traits.pointLightCount = 1;
      scene::Request request;
      request.bounces = bounces;
      const gpu::Capabilities none;
      graph::Declaration declaration(traits, request, none);
      frame::Composite().declare(declaration);
      for (const graph::Port& port : declaration.ports) {
        if (port.name != "indirect") continue;
        EXPECT_EQ(port.unwanted, !sky && bounces == 0);
        EXPECT_EQ(port.unwantedReason, !sky && bounces == 0 ? "0 bounces asked for and no sky" : "");
      }
    }
  }
}

TEST_F(CompositeTest, EmitterShowsOnlyItsFront) {
  SceneBuilder b;
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), {3.f, 2.f, 1.f});
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f}, lamp);
  for (const float side : {1.f, -1.f}) {
    b.lookAt({0.f, 0.f, 2.f * side}, {0.f, 0.f, 0.f}, 0.5f);
    FrameRun run(device(), b.scene, {.width = 8, .height = 8});
    for (const glm::vec4& color : run.pixels("composite.color")) expectNear(color, side > 0.f ? glm::vec3(3.f, 2.f, 1.f) : glm::vec3(0.f));
  }
}

TEST_F(CompositeTest, SceneWithoutLightIsBlackAndSkipsLighting) {
  SceneBuilder b;
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f});
  b.lookAt({0.f, 0.f, 3.f}, {0.f, 0.f, 0.f});
  FrameRun run(device(), b.scene, {.width = 8, .height = 8, .outputs = {"composite.color", "tone_map.display"}});
  for (const glm::vec4& color : run.pixels("composite.color")) expectNear(color, glm::vec3(0.f));
  EXPECT_FALSE(run.has("direct.irradiance"));
  EXPECT_FALSE(run.has("shadow_map.depth"));
  EXPECT_NE(run.culledReason("direct"), "");
  EXPECT_NE(run.culledReason("shadow_map"), "");
}

}  // namespace
}  // namespace radivox
