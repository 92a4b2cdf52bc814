// Shadows of direct light: per pixel against rays, at contacts, on curved surfaces, in penumbrae.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/light_oracle.h"

namespace radivox {
namespace {

using frame_test::FrameOptions;
using frame_test::FrameRun;
using frame_test::SceneBuilder;
using oracles::LightOracle;

class ShadowTest : public oracles::GpuTest {};

FrameOptions options(uint32_t width, uint32_t height) {
  FrameOptions o;
  o.width = width;
  o.height = height;
  o.outputs = {"direct.irradiance", "gbuffer.position", "gbuffer.normal", "gbuffer.triangle"};
  return o;
}

/// Shadows by rays through the triangles in voxels.
FrameOptions withRays(FrameOptions o, uint32_t resolution = 48) {
  o.voxels = resolution;
  o.bounces = 1;
  return o;
}

/// A floor, a wall behind it, and boxes: two on the floor, one in the air.
SceneBuilder makeCourt() {
  SceneBuilder b;
  b.addQuad({-5.f, 0.f, 5.f}, {5.f, 0.f, 5.f}, {5.f, 0.f, -5.f}, {-5.f, 0.f, -5.f});
  b.addQuad({-5.f, 0.f, -5.f}, {5.f, 0.f, -5.f}, {5.f, 4.f, -5.f}, {-5.f, 4.f, -5.f});
  b.addBox({-2.f, 0.f, -1.f}, {-1.f, 2.f, 1.f});
  b.addBox({0.5f, 0.f, 0.f}, {2.f, 0.7f, 1.5f});
  b.addBox({0.f, 2.f, -2.f}, {1.f, 2.5f, -1.f});
  b.lookAt({3.f, 5.f, 8.f}, {0.f, 0.8f, -0.5f}, 0.8f);
  return b;
}

/// Half a pixel's diagonal in makeCourt's view, on the ground: what exact edges are smoothed over.
constexpr double kPixelReach = 0.1;

struct Tally {
  size_t compared = 0, wrong = 0, near = 0;
};

/// Pixels whose visibility is the same all around within `radius` must have exactly that visibility.
Tally compareVisibility(FrameRun& run, const SceneBuilder& b, double radius) {
  const auto position = run.pixels("gbuffer.position"), normal = run.pixels("gbuffer.normal"), irradiance = run.pixels("direct.irradiance");
  const auto triangle = run.words("gbuffer.triangle");
  const LightOracle oracle(b.scene);
  const scene::PunctualLight& light = b.scene.lights.front();
  Tally tally;
  for (size_t i = 0; i < position.size(); ++i) {
    if (triangle[i] == 0) continue;
    const glm::dvec3 p(position[i]), n(normal[i]);
    glm::dvec3 g = oracle.normal(triangle[i] - 1);
    if (glm::dot(g, n) < 0) g = -g;
    const glm::dvec3 full = oracle.punctualIrradiance(p, n, g, false);
    if (full.x <= 0) {
      EXPECT_EQ(irradiance[i].x, 0.f);
      continue;
    }
    const glm::dvec3 lifted = p + 1e-5 * g;
    const glm::dvec3 u = glm::normalize(glm::cross(g, std::abs(g.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0))),
                     v = glm::cross(g, u);
    bool certain = true, first = false;
    for (int k = 0; k <= 16 && certain; ++k) {
      const double angle = k * std::numbers::pi / 4;
      const double r = k == 0 ? 0 : (k <= 8 ? 1 : 0.5) * radius;
      const glm::dvec3 q = lifted + r * (std::cos(angle) * u + std::sin(angle) * v);
      const bool blocked = light.type == shared::kLightDirectional ? oracle.isBlockedAlong(q, -glm::dvec3(light.direction), 1e-9)
                                                                   : oracle.isBlocked(q, glm::dvec3(light.position), 1e-9);
      if (k == 0) first = blocked;
      certain = blocked == first;
    }
    if (!certain) {
      ++tally.near;
      continue;
    }
    ++tally.compared;
    const double expected = first ? 0 : full.x;
    if (std::abs(irradiance[i].x - expected) > 1e-4 * full.x + 1e-6) ++tally.wrong;
  }
  return tally;
}

/// filter: "exact", "rays", or the filter's half width in texels. What is near an edge: `radius`, or for exact edges a pixel of at most 6 cm, which is
/// longer on the ground.
void checkCourt(gpu::Device& device, const SceneBuilder& b, const std::string& filter, double radius, const char* name) {
  FrameOptions o = options(160, 120);
  if (filter == "rays") o = withRays(o);
  if (filter != "exact" && filter != "rays") o.settings = {{"direct.edges", "filtered"}, {"direct.filter", filter}};
  FrameRun run(device, b.scene, o);
  const Tally tally = compareVisibility(run, b, radius);
  frame_test::show(run.picture("direct.irradiance"), std::string("court_") + name + "_" + filter);
  std::printf("%s, filter %s: %zu pixels, %zu wrong, %zu near an edge\n", name, filter.c_str(), tally.compared, tally.wrong, tally.near);
  EXPECT_EQ(tally.wrong, 0u);
  EXPECT_GT(tally.compared, 6 * tally.near);
  EXPECT_GT(tally.compared, 7000u);
}

TEST_F(ShadowTest, BoxesUnderTheSun) {
  SceneBuilder b = makeCourt();
  b.addSun({0.5f, -1.f, -0.3f}, glm::vec3(3.f));
  // Texels are 7 mm; a filter of r texels reaches r·√2 of them, longer by 1/cos on the ground.
  for (const char* filter : {"0", "1", "3"}) checkCourt(device(), b, filter, 0.012 * (std::stod(filter) + 1), "sun");
  for (const char* edges : {"exact", "rays"}) checkCourt(device(), b, edges, kPixelReach, "sun");
}

TEST_F(ShadowTest, BoxesUnderALowSun) {
  SceneBuilder b = makeCourt();
  b.addSun({1.f, -0.25f, -0.4f}, glm::vec3(3.f));
  checkCourt(device(), b, "1", 0.08, "low sun");
  for (const char* edges : {"exact", "rays"}) checkCourt(device(), b, edges, kPixelReach, "low sun");
}

TEST_F(ShadowTest, BoxesAroundAPointLight) {
  SceneBuilder b = makeCourt();
  b.addPoint({0.f, 1.5f, 0.2f}, glm::vec3(10.f));  // all six views are in use
  checkCourt(device(), b, "1", 0.06, "point");
  for (const char* edges : {"exact", "rays"}) checkCourt(device(), b, edges, kPixelReach, "point");
}

TEST_F(ShadowTest, BoxesUnderASpot) {
  SceneBuilder b = makeCourt();
  b.addSpot({3.f, 5.f, 3.f}, {-0.6f, -1.f, -0.6f}, glm::vec3(50.f), 0.5f, 0.6f);
  checkCourt(device(), b, "1", 0.03, "spot");
  for (const char* edges : {"exact", "rays"}) checkCourt(device(), b, edges, kPixelReach, "spot");
}

TEST_F(ShadowTest, NothingLeaksUnderAThinWall) {
  // A sheet without thickness on a floor that runs under it, seen from right above: its light side is full, its shadow side black up to
  // the very edge. Coarse maps make it hard.
  for (const float tilt : {0.2f, 1.f, 3.f}) {
    SceneBuilder b;
    b.addQuad({-5.f, 0.f, 5.f}, {5.f, 0.f, 5.f}, {5.f, 0.f, -5.f}, {-5.f, 0.f, -5.f});
    b.addQuad({0.f, 0.f, 4.f}, {0.f, 0.f, -4.f}, {0.f, 2.f, -4.f}, {0.f, 2.f, 4.f});
    b.addSun({tilt, -1.f, 0.1f}, glm::vec3(2.f));
    b.lookParallel({0.f, 9.f, 0.f}, {0.f, 0.f, 0.f}, 0.05f);
    FrameOptions o = options(64, 64);
    o.lights.shadowResolution = 256;
    for (const std::string filter : {"0", "1", "3", "exact", "rays"}) {
      o.settings = {{"direct.edges", "filtered"}, {"direct.filter", filter}};
      if (filter == "exact" || filter == "rays") o.settings.clear();
      FrameRun run(device(), b.scene, filter == "rays" ? withRays(o) : o);
      const auto position = run.pixels("gbuffer.position"), irradiance = run.pixels("direct.irradiance");
      const auto triangle = run.words("gbuffer.triangle");
      const double full = 2.0 / std::sqrt(1.01 + double{tilt} * double{tilt});
      for (size_t i = 0; i < position.size(); ++i) {
        if (triangle[i] > 2 || std::abs(position[i].x) < 1e-4f) continue;
        EXPECT_NEAR(irradiance[i].x, position[i].x < 0.f ? full : 0.0, 1e-4)
            << "x = " << position[i].x << ", tilt " << tilt << ", filter " << filter;
      }
    }
  }
}

TEST_F(ShadowTest, NothingLeaksAlongAThinWallFromAPoint) {
  SceneBuilder b;
  b.addQuad({-5.f, 0.f, 5.f}, {5.f, 0.f, 5.f}, {5.f, 0.f, -5.f}, {-5.f, 0.f, -5.f});
  b.addQuad({0.f, 0.f, 4.f}, {0.f, 0.f, -4.f}, {0.f, 2.f, -4.f}, {0.f, 2.f, 4.f});
  b.addPoint({-2.f, 1.f, 0.3f}, glm::vec3(20.f));
  b.lookParallel({0.f, 9.f, 0.f}, {0.f, 0.f, 0.f}, 0.05f);
  FrameOptions o = options(64, 64);
  o.lights.pointShadowResolution = 128;
  for (const bool rays : {false, true}) {
    FrameRun run(device(), b.scene, rays ? withRays(o) : o);
    const auto position = run.pixels("gbuffer.position"), irradiance = run.pixels("direct.irradiance");
    const LightOracle oracle(b.scene);
    for (size_t i = 0; i < position.size(); ++i) {
      if (position[i].y > 0.01f || std::abs(position[i].x) < 1e-4f) continue;
      const double full = oracle.punctualIrradiance(glm::dvec3(position[i]), {0, 1, 0}, {0, 1, 0}, false).x;
      EXPECT_NEAR(irradiance[i].x, position[i].x < 0.f ? full : 0.0, 1e-4 * full) << "x = " << position[i].x << (rays ? ", rays" : "");
    }
  }
}

/// Latitude-longitude sphere with smooth normals.
void addSphere(SceneBuilder& b, const glm::vec3& centre, float radius, uint32_t rings) {
  const uint32_t sectors = 2 * rings;
  const auto at = [&](uint32_t ring, uint32_t sector) {
    const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
    const float phi = 2.f * std::numbers::pi_v<float> * static_cast<float>(sector) / static_cast<float>(sectors);
    return centre + radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
  };
  const size_t first = b.scene.vertices.size();
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t s = 0; s < sectors; ++s) {
      if (r > 0) b.addTriangle(at(r, s), at(r + 1, s), at(r, s + 1));
      if (r + 1 < rings) b.addTriangle(at(r, s + 1), at(r + 1, s), at(r + 1, s + 1));
    }
  for (size_t i = first; i < b.scene.vertices.size(); ++i)
    b.scene.vertices[i].normal = glm::normalize(b.scene.vertices[i].position - centre);
}

TEST_F(ShadowTest, SlowCurvedSurfacesHaveNoAcne) {
  // Convex from outside, concave from inside, coarse and fine: what rays say is lit must be fully lit.
  for (const uint32_t rings : {8u, 64u}) {
    for (const bool inside : {false, true}) {
      SceneBuilder b;
      addSphere(b, glm::vec3(0.f), 2.f, rings);
      if (inside) {
        b.addPoint({0.3f, 0.5f, -0.2f}, glm::vec3(10.f));
        b.lookAt({0.f, 0.f, 1.5f}, {0.f, 0.f, -2.f}, 1.5f);
      } else {
        b.addSun({0.4f, -1.f, -0.5f}, glm::vec3(10.f));
        b.lookAt({0.f, 2.f, 6.f}, {0.f, 0.f, 0.f}, 0.8f);
      }
      FrameOptions o = options(96, 96);
      o.lights.shadowResolution = o.lights.pointShadowResolution = 256;
      for (const bool rays : {false, true}) {
        FrameRun run(device(), b.scene, rays ? withRays(o) : o);
        frame_test::show(run.picture("direct.irradiance"),
                         "sphere_" + std::to_string(rings) + (inside ? "_inside" : "_outside") + (rays ? "_rays" : ""));
        const auto position = run.pixels("gbuffer.position"), normal = run.pixels("gbuffer.normal"),
                   irradiance = run.pixels("direct.irradiance");
        const auto triangle = run.words("gbuffer.triangle");
        const LightOracle oracle(b.scene);
        size_t lit = 0, wrong = 0;
        for (size_t i = 0; i < position.size(); ++i) {
          if (triangle[i] == 0) continue;
          const glm::dvec3 p(position[i]), n(normal[i]);
          glm::dvec3 g = oracle.normal(triangle[i] - 1);
          if (glm::dot(g, n) < 0) g = -g;
          const double expected = oracle.punctualIrradiance(p + 1e-5 * g, n, g, true).x;
          if (expected <= 0) continue;
          ++lit;
          if (std::abs(irradiance[i].x - expected) > 1e-3 * expected) ++wrong;
        }
        EXPECT_GT(lit, 1000u);
        EXPECT_EQ(wrong, 0u) << rings << (inside ? " inside" : " outside") << (rays ? ", rays" : "") << ", of " << lit;
      }
    }
  }
}

/// Ledges that stand out of a wall, thinner than what a texel of the shadow map is wide.
SceneBuilder makeLedges(float reach, uint32_t flags = 0) {
  SceneBuilder b;
  const uint32_t ledge = b.addMaterial(glm::vec3(0.5f), glm::vec3(0.f), flags);
  b.addQuad({-5.f, 0.f, 0.f}, {5.f, 0.f, 0.f}, {5.f, 5.f, 0.f}, {-5.f, 5.f, 0.f});
  for (int i = 0; i < 20; ++i) {
    const float y = 0.13f + 0.23f * static_cast<float>(i);
    b.addQuad({-5.f, y, reach}, {5.f, y, reach}, {5.f, y, 0.f}, {-5.f, y, 0.f}, ledge);
  }
  b.lookAt({0.5f, 2.2f, 1.6f}, {0.f, 2.4f, 0.f}, 0.9f);
  return b;
}

TEST_F(ShadowTest, RaysFindOccludersThatMapsMiss) {
  SceneBuilder b = makeLedges(0.04f);
  for (const bool isPoint : {false, true}) {
    b.scene.lights.clear();
    if (isPoint) {
      b.addPoint({0.4f, 4.7f, 0.7f}, glm::vec3(9.f));
    } else {
      b.addSun({0.3f, -1.f, -0.6f}, glm::vec3(3.f));
    }
    FrameOptions o = options(120, 90);
    o.lights.shadowResolution = o.lights.pointShadowResolution = 64;  // texels of 15 cm
    FrameRun maps(device(), b.scene, o), rays(device(), b.scene, withRays(o));
    const std::string name = isPoint ? "ledges_point" : "ledges_sun";
    frame_test::show(maps.picture("direct.irradiance"), name + "_maps");
    frame_test::show(rays.picture("direct.irradiance"), name + "_rays");
    const Tally missed = compareVisibility(maps, b, 0.025), found = compareVisibility(rays, b, 0.025);
    std::printf("%s: %zu pixels, wrong %zu by maps, %zu by rays, %zu near an edge\n", name.c_str(), found.compared, missed.wrong,
                found.wrong, found.near);
    EXPECT_GT(found.compared, 5000u);
    EXPECT_GT(missed.wrong, found.compared / 10) << "the test wants thin occluders";
    EXPECT_EQ(found.wrong, 0u);
  }
}

TEST_F(ShadowTest, RaysObeySidesAndMasks) {
  const auto mean = [&](const SceneBuilder& b, bool rays, std::vector<std::pair<std::string, std::string>> settings = {}) {
    FrameOptions o = options(96, 72);
    o.settings = std::move(settings);
    FrameRun run(device(), b.scene, rays ? withRays(o) : o);
    double sum = 0;
    for (const glm::vec4& e : run.pixels("direct.irradiance")) sum += e.x;
    return sum / (96 * 72);
  };
  // From below, the ledges show the light their backs.
  SceneBuilder b = makeLedges(0.1f);
  b.addSun({0.3f, 1.f, -0.6f}, glm::vec3(3.f));
  const double both = mean(b, true), gltf = mean(b, true, {{"direct.sides", "gltf"}, {"shadow_map.sides", "gltf"}});
  EXPECT_NEAR(both / mean(b, false), 1.0, 0.02);
  EXPECT_NEAR(gltf / mean(b, false, {{"shadow_map.sides", "gltf"}}), 1.0, 0.02);
  EXPECT_GT(gltf, 1.2 * both);
  // Half of each ledge is holes.
  SceneBuilder masked = makeLedges(0.1f, shared::kMaterialAlphaMask);
  masked.scene.lights = b.scene.lights;
  scene::TextureImage stripes;
  stripes.name = "stripes";
  stripes.width = 8;
  stripes.height = 1;
  stripes.nearest = true;
  for (uint32_t i = 0; i < 8; ++i) stripes.rgba.insert(stripes.rgba.end(), {255, 255, 255, static_cast<uint8_t>(i % 2 == 0 ? 255 : 0)});
  masked.scene.textures.push_back(stripes);
  masked.scene.materials.back().baseTexture = 0;
  const double holes = mean(masked, true);
  EXPECT_NEAR(holes / mean(masked, false), 1.0, 0.02);
  EXPECT_GT(holes, 1.1 * both);
}

TEST_F(ShadowTest, WhereVoxelsHoldTooManyTrianglesMapsDecide) {
  SceneBuilder b = makeCourt();
  b.addSun({0.5f, -1.f, -0.3f}, glm::vec3(3.f));
  FrameOptions crowded = withRays(options(160, 120), 8);
  crowded.settings = {{"triangles.most", "1"}};
  FrameRun run(device(), b.scene, crowded);
  const Tally tally = compareVisibility(run, b, kPixelReach);
  EXPECT_EQ(tally.wrong, 0u);
  EXPECT_GT(tally.compared, 7000u);
}

TEST_F(ShadowTest, RaysAreLeftOutWithoutIndirectLight) {
  SceneBuilder b = makeCourt();
  b.addSun({0.5f, -1.f, -0.3f}, glm::vec3(3.f));
  FrameOptions o = withRays(options(32, 24));
  EXPECT_EQ(FrameRun(device(), b.scene, o).culledReason("triangles"), "");
  o.bounces = 0;
  EXPECT_NE(FrameRun(device(), b.scene, o).culledReason("triangles").find("0 bounces"), std::string::npos);
  o.bounces = 1;
  o.settings = {{"direct.rays", "false"}};
  EXPECT_NE(FrameRun(device(), b.scene, o).culledReason("triangles").find("maps alone"), std::string::npos);
}

TEST_F(ShadowTest, PenumbraOfAnEmitterMatchesIntegration) {
  SceneBuilder b;
  b.addQuad({-3.f, 0.f, 3.f}, {3.f, 0.f, 3.f}, {3.f, 0.f, -3.f}, {-3.f, 0.f, -3.f});
  b.addBox({-0.5f, 1.f, -0.5f}, {0.5f, 1.2f, 0.5f});
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(10.f));
  b.addQuad({-0.6f, 3.f, -0.6f}, {0.6f, 3.f, -0.6f}, {0.6f, 3.f, 0.6f}, {-0.6f, 3.f, 0.6f}, lamp);
  b.lookAt({0.f, 2.6f, 4.f}, {0.f, 0.f, 0.f}, 0.7f);
  FrameRun run(device(), b.scene, options(80, 60));
  frame_test::show(run.picture("direct.irradiance"), "penumbra");
  const auto position = run.pixels("gbuffer.position"), irradiance = run.pixels("direct.irradiance");
  const LightOracle oracle(b.scene);
  double error2 = 0, sum = 0, expectedSum = 0, worst = 0;
  size_t count = 0, partial = 0;
  for (size_t i = 0; i < position.size(); i += 3) {
    if (position[i].w == 0.f || position[i].y > 1e-3f) continue;
    const glm::dvec3 p(position[i]), up(0, 1, 0);
    const double expected = oracle.emitterIrradiance(p, up, up, 4, true).x, full = oracle.emitterIrradiance(p, up, up, 4, false).x;
    const double miss = (irradiance[i].x - expected) / full;
    if (expected < 0.95 * full && expected > 0.05 * full) ++partial;
    if (expected == full || expected == 0) {
      // Next to the penumbra the filter of the nearest sample may reach over its edge: half of one sample in 32, times its weight.
      EXPECT_NEAR(irradiance[i].x, expected, 0.02 * full);
    }
    error2 += miss * miss;
    worst = std::max(worst, std::abs(miss));
    sum += irradiance[i].x;
    expectedSum += expected;
    ++count;
  }
  std::printf("penumbra: %zu pixels (%zu partly shadowed), bias %.4f, rms %.4f of the unshadowed, worst %.3f\n", count, partial,
              sum / expectedSum, std::sqrt(error2 / static_cast<double>(count)), worst);
  EXPECT_GT(partial, count / 10);
  EXPECT_NEAR(sum / expectedSum, 1.0, 0.01);
  EXPECT_LT(std::sqrt(error2 / static_cast<double>(count)), 0.017);
  EXPECT_LT(worst, 0.12);
}

TEST_F(ShadowTest, TwoRunsGiveTheSameBits) {
  SceneBuilder b = makeCourt();
  b.addSun({0.5f, -1.f, -0.3f}, glm::vec3(3.f));
  b.addPoint({0.f, 1.5f, 0.2f}, glm::vec3(10.f));
  const uint32_t lamp = b.addMaterial(glm::vec3(0.f), glm::vec3(10.f));
  b.addQuad({-0.6f, 3.f, -0.6f}, {0.6f, 3.f, -0.6f}, {0.6f, 3.f, 0.6f}, {-0.6f, 3.f, 0.6f}, lamp);
  FrameOptions o = options(96, 64);
  o.outputs = {"direct.irradiance", "composite.color", "tone_map.display"};
  FrameRun first(device(), b.scene, o), second(device(), b.scene, o);
  EXPECT_EQ(first.words("direct.irradiance"), second.words("direct.irradiance"));
  EXPECT_EQ(first.words("composite.color"), second.words("composite.color"));
  EXPECT_EQ(first.words("tone_map.display"), second.words("tone_map.display"));
}

}  // namespace
}  // namespace radivox
