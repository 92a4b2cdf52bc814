// Direct light without occluders against closed forms, and on which sides of a surface it lands.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/scene/builtin.h"
#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/light_oracle.h"

namespace radivox {
namespace {

using frame_test::FrameOptions;
using frame_test::FrameRun;
using frame_test::SceneBuilder;
using oracles::LightOracle;

class DirectTest : public oracles::GpuTest {};

FrameOptions directOnly(uint32_t width, uint32_t height) {
  FrameOptions options;
  options.width = width;
  options.height = height;
  options.outputs = {"direct.irradiance", "gbuffer.position", "gbuffer.normal"};
  return options;
}

/// The plane y = 0 for |x|, |z| < 5, seen from above.
SceneBuilder makePlane() {
  SceneBuilder b;
  b.addQuad({-5.f, 0.f, 5.f}, {5.f, 0.f, 5.f}, {5.f, 0.f, -5.f}, {-5.f, 0.f, -5.f});
  b.lookAt({0.f, 6.f, 4.f}, {0.f, 0.f, 0.f}, 0.7f);
  return b;
}

struct Sample {
  glm::dvec3 position, normal, irradiance;
};

std::vector<Sample> surfaces(FrameRun& run) {
  const auto position = run.pixels("gbuffer.position"), normal = run.pixels("gbuffer.normal"), irradiance = run.pixels("direct.irradiance");
  std::vector<Sample> all;
  for (size_t i = 0; i < position.size(); ++i) {
    EXPECT_EQ(irradiance[i].a, position[i].w == 0.f ? 0.f : 1.f);
    if (position[i].w != 0.f) all.push_back({glm::dvec3(position[i]), glm::dvec3(normal[i]), glm::dvec3(irradiance[i])});
  }
  EXPECT_GT(all.size(), position.size() / 2);
  return all;
}

void expectClose(const Sample& s, const glm::dvec3& expected, double relative, double absolute = 1e-6) {
  EXPECT_LE(glm::length(s.irradiance - expected), relative * glm::length(expected) + absolute)
      << s.irradiance.x << " not " << expected.x << " at " << s.position.x << ", " << s.position.y << ", " << s.position.z;
}

TEST_F(DirectTest, PlaneUnderSun) {
  SceneBuilder b = makePlane();
  b.addSun({0.62f, -1.f, 0.19f}, {10.f, 5.f, 2.f});
  FrameRun run(device(), b.scene, directOnly(48, 32));
  // 10 W/m² along (0.62, −1, 0.19): what the independent renders have on Sponza's floor.
  for (const Sample& s : surfaces(run)) expectClose(s, glm::dvec3(8.390, 4.195, 1.678), 1e-4);
}

TEST_F(DirectTest, PointLightFallsWithTheSquareAndStopsAtItsRange) {
  for (const float range : {0.f, 4.f}) {
    SceneBuilder b = makePlane();
    b.addPoint({0.5f, 1.5f, -0.5f}, {30.f, 20.f, 10.f}, range);
    FrameRun run(device(), b.scene, directOnly(64, 48));
    const LightOracle oracle(b.scene);
    double least = 1e9;
    for (const Sample& s : surfaces(run)) {
      const glm::dvec3 expected = oracle.punctualIrradiance(s.position, s.normal, s.normal, false);
      expectClose(s, expected, 2e-5);
      least = std::min(least, s.irradiance.x);
    }
    EXPECT_EQ(least == 0.0, range > 0.f);
    // Under the light: I / h².
    const glm::dvec3 below = oracle.punctualIrradiance({0.5, 0, -0.5}, {0, 1, 0}, {0, 1, 0}, false);
    if (range == 0.f) {
      EXPECT_NEAR(below.x, 30 / 2.25, 1e-9);
    }
  }
}

TEST_F(DirectTest, SpotConeFadesFromInnerToOuter) {
  SceneBuilder b = makePlane();
  b.addSpot({-1.f, 3.f, 0.f}, {0.3f, -1.f, 0.1f}, glm::vec3(40.f), 0.25f, 0.5f);
  b.addSpot({1.f, 2.f, 1.f}, {0.f, -1.f, 0.f}, {0.f, 9.f, 0.f}, 0.f, 1.3f);  // wide: several views
  FrameRun run(device(), b.scene, directOnly(64, 48));
  const LightOracle oracle(b.scene);
  size_t dark = 0, full = 0;
  for (const Sample& s : surfaces(run)) {
    expectClose(s, oracle.punctualIrradiance(s.position, s.normal, s.normal, false), 1e-4, 1e-5);
    (s.irradiance.x == 0.0 ? dark : full) += 1;
  }
  EXPECT_GT(dark, 100u);
  EXPECT_GT(full, 100u);
}

TEST_F(DirectTest, EmissiveQuadOverPlane) {
  SceneBuilder b = makePlane();
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), {17.f, 12.f, 4.f});
  b.addQuad({-1.f, 1.5f, -0.7f}, {1.f, 1.5f, -0.7f}, {1.f, 1.5f, 0.7f}, {-1.f, 1.5f, 0.7f}, lamp);
  FrameRun run(device(), b.scene, directOnly(32, 24));
  const LightOracle oracle(b.scene);
  size_t lit = 0;
  for (const Sample& s : surfaces(run)) {
    if (s.position.y > 0.1) continue;  // the quad's own back
    expectClose(s, oracle.emitterIrradiance(s.position, s.normal, s.normal, 6, false), 1e-3);
    ++lit;
  }
  EXPECT_GT(lit, 300u);
  // Below the centre: the closed form of a rectangle's corner (a, b at height c), four times.
  const double a = 1, c = 1.5, d = 0.7;
  const double x = a / c, y = d / c;
  const double corner =
      (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) + y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
      (2 * std::numbers::pi);
  EXPECT_NEAR(oracle.emitterIrradiance({0, 0, 0}, {0, 1, 0}, {0, 1, 0}, 7, false).x, 17 * std::numbers::pi * 4 * corner, 1e-2);
}

TEST_F(DirectTest, EmitterNearlyTouchingIsNotSingular) {
  SceneBuilder b = makePlane();
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(2.f));
  // Faces the floor from 5 mm; beside it a wall that it stands on, half of it below that wall's points' horizon.
  b.addQuad({-1.f, 0.005f, -1.f}, {1.f, 0.005f, -1.f}, {1.f, 0.005f, 1.f}, {-1.f, 0.005f, 1.f}, lamp);
  b.scene.cameras.front().position = {-0.6f, 0.002f, -0.6f};
  b.lookAt({-1.5f, 0.002f, -0.2f}, {0.f, 0.f, 0.f}, 0.01f);
  FrameRun run(device(), b.scene, directOnly(16, 16));
  for (const Sample& s : surfaces(run)) {
    if (s.normal.y < 0.5 || s.position.y > 0.001) continue;
    EXPECT_LE(s.irradiance.x, 2 * std::numbers::pi * 1.0001);
    if (std::abs(s.position.x) < 0.8 && std::abs(s.position.z) < 0.8) {
      EXPECT_NEAR(s.irradiance.x, 2 * std::numbers::pi, 0.02);
    }
  }
}

TEST_F(DirectTest, EmitterCutByTheHorizon) {
  // A wall that an upright emitter beside it meets at a right angle, and a floor below it: parts of the emitter are under the horizon.
  SceneBuilder b;
  b.addQuad({-2.f, 0.f, 0.f}, {2.f, 0.f, 0.f}, {2.f, 2.f, 0.f}, {-2.f, 2.f, 0.f});
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(5.f));
  b.addQuad({-2.f, 0.5f, -1.f}, {-2.f, 0.5f, 1.f}, {-2.f, 1.5f, 1.f}, {-2.f, 1.5f, -1.f}, lamp);
  b.lookAt({0.f, 1.f, 4.f}, {0.f, 1.f, 0.f}, 0.5f);
  FrameOptions options = directOnly(32, 16);
  FrameRun run(device(), b.scene, options);
  const LightOracle oracle(b.scene);
  for (const Sample& s : surfaces(run))
    if (s.position.x > -1.9) expectClose(s, oracle.emitterIrradiance(s.position, s.normal, s.normal, 7, false), 4e-3);
}

TEST_F(DirectTest, FarEmitterHasNoCancellation) {
  SceneBuilder b = makePlane();
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(1e6f));
  b.addQuad({2000.f, 3000.f, 0.f}, {2001.f, 3000.f, 0.f}, {2001.f, 3000.f, 1.f}, {2000.f, 3000.f, 1.f}, lamp);
  FrameOptions options = directOnly(16, 16);
  FrameRun run(device(), b.scene, options);
  const LightOracle oracle(b.scene);
  for (const Sample& s : surfaces(run)) expectClose(s, oracle.emitterIrradiance(s.position, s.normal, s.normal, 1, false), 1e-3);
}

TEST_F(DirectTest, ManyEmissiveTrianglesAreSampled) {
  SceneBuilder b = makePlane();
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(3.f));
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 10; ++j) {
      const float x = -1.f + 0.1f * static_cast<float>(i), z = -0.5f + 0.1f * static_cast<float>(j);
      b.addQuad({x, 2.f, z}, {x + 0.1f, 2.f, z}, {x + 0.1f, 2.f, z + 0.1f}, {x, 2.f, z + 0.1f}, lamp);
    }
  FrameOptions options = directOnly(32, 24);
  FrameRun sampled(device(), b.scene, options);
  options.settings = {{"direct.closed_form", "4096"}};
  FrameRun exact(device(), b.scene, options);
  const auto s = surfaces(sampled), e = surfaces(exact);
  for (size_t i = 0; i < s.size(); ++i)
    if (s[i].position.y < 0.1) expectClose(s[i], e[i].irradiance, 0.08);
}

TEST_F(DirectTest, FurnaceWithoutSamplesStaysExact) {
  const scene::Scene furnace = scene::makeBuiltin("furnace", {{"albedo", "0.25"}});
  ASSERT_TRUE(scene::traitsFor(furnace, {}).emittersByRays);
  FrameRun run(device(), furnace, directOnly(24, 16));
  // L_e = (1 − ρ)/π all around: E = 1 − ρ.
  for (const Sample& s : surfaces(run)) expectClose(s, glm::dvec3(0.75), 2e-5);
  EXPECT_GT(run.figure("direct", "emitters_unshadowed"), 0.0);
}

TEST_F(DirectTest, NoLightThroughTheBack) {
  const scene::Scene wall = scene::makeBuiltin("thin_wall");
  SceneBuilder b;
  b.scene = wall;
  const glm::vec3 middle = 0.5f * (wall.traits().boundsMin + wall.traits().boundsMax);
  const glm::vec3 n = wall.vertices[wall.indices[0]].normal;
  const glm::vec3 towardsSun = -wall.lights.front().direction;
  double lit[2] = {0, 0};
  for (const float side : {1.f, -1.f}) {
    b.lookAt(middle + 3.f * side * n, middle, 0.3f);
    FrameRun run(device(), b.scene, directOnly(16, 16));
    for (const Sample& s : surfaces(run)) {
      const bool front = glm::dot(side * n, towardsSun) > 0.f;
      if (front)
        expectClose(s, glm::dvec3(wall.lights.front().intensity) * double{glm::dot(side * n, towardsSun)}, 1e-5);
      else
        EXPECT_EQ(s.irradiance, glm::dvec3(0));
      lit[side > 0.f ? 0 : 1] += s.irradiance.y;
    }
  }
  EXPECT_GT(std::max(lit[0], lit[1]), 0.0);
  EXPECT_EQ(std::min(lit[0], lit[1]), 0.0);
}

TEST_F(DirectTest, LeaningShadingNormalLetsNothingThrough) {
  // The light is behind the triangle, but its vertex normals lean so far over that they face it.
  SceneBuilder b;
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f});
  for (auto& vertex : b.scene.vertices) vertex.normal = glm::normalize(glm::vec3(0.f, 1.f, 0.2f));
  b.addPoint({0.f, 8.f, -1.f}, glm::vec3(100.f));
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(9.f));
  b.addQuad({-1.f, 5.f, -3.f}, {1.f, 5.f, -3.f}, {1.f, 5.f, -1.f}, {-1.f, 5.f, -1.f}, lamp);
  b.lookAt({0.f, 0.f, 4.f}, {0.f, 0.f, 0.f}, 0.4f);
  FrameOptions options = directOnly(16, 16);
  options.settings = {{"direct.filter", "0"}};
  FrameRun run(device(), b.scene, options);
  for (const Sample& s : surfaces(run)) EXPECT_EQ(s.irradiance, glm::dvec3(0));
}

TEST_F(DirectTest, EmittedImageIsAddedWhereEmittersHaveNoSamples) {
  SceneBuilder b = makePlane();
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(1.f));
  b.addQuad({-1.f, 2.f, -1.f}, {1.f, 2.f, -1.f}, {1.f, 2.f, 1.f}, {-1.f, 2.f, 1.f}, lamp);
  for (const uint32_t samples : {0u, 8u}) {
    scene::LightOptions lights;
    lights.emitterSamples = samples;
    const scene::Traits traits = scene::traitsFor(b.scene, lights);
    const scene::Request request;
    const gpu::Capabilities none;
    graph::Declaration declaration(traits, request, none);
    frame_test::makeNode("frame.direct")->declare(declaration);
    for (const graph::Port& port : declaration.ports)
      if (port.name == "emitted") {
        EXPECT_EQ(port.unwanted, samples > 0);
      }
  }
}

}  // namespace
}  // namespace radivox
