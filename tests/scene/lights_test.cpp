// Shadow views and emitter samples against their definitions.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "engine/scene/geometry.h"
#include "engine/scene/light_setup.h"
#include "tests/gpu/expect_error.h"

namespace radivox::tests {
namespace {

using scene::LightOptions;
using scene::LightSetup;
using scene::loadScene;
using scene::PunctualLight;
using scene::Scene;
using scene::setUpLights;

constexpr double kPi = glm::pi<double>();

/// No two tiles of a layer meet; all lie in their layer.
void expectSoundTiles(const LightSetup& setup) {
  for (size_t i = 0; i < setup.views.size(); ++i) {
    const auto& a = setup.views[i];
    ASSERT_LT(a.layer, setup.shadowLayers);
    ASSERT_LE(a.offsetX + a.resolution, setup.shadowResolution);
    ASSERT_LE(a.offsetY + a.resolution, setup.shadowResolution);
    for (size_t j = 0; j < i; ++j) {
      const auto& b = setup.views[j];
      if (a.layer != b.layer) continue;
      const bool apart = a.offsetX + a.resolution <= b.offsetX || b.offsetX + b.resolution <= a.offsetX ||
                         a.offsetY + a.resolution <= b.offsetY || b.offsetY + b.resolution <= a.offsetY;
      ASSERT_TRUE(apart) << i << " and " << j;
    }
  }
}

void expectConsistent(const LightSetup& setup) {
  expectSoundTiles(setup);
  uint32_t next = 0;
  for (size_t l = 0; l < setup.lights.size(); ++l) {
    EXPECT_EQ(setup.lights[l].firstShadowView, next);
    for (uint32_t i = 0; i < setup.lights[l].shadowViewCount; ++i) EXPECT_EQ(setup.views[next + i].light, l);
    next += setup.lights[l].shadowViewCount;
  }
  EXPECT_EQ(next, setup.views.size());
  for (const auto& view : setup.views) {
    const glm::dmat4 product = glm::dmat4(view.viewProjection) * glm::dmat4(view.inverseViewProjection);
    for (glm::length_t c = 0; c < 4; ++c) {
      for (glm::length_t r = 0; r < 4; ++r) EXPECT_NEAR(product[c][r], c == r ? 1 : 0, 2e-3);
    }
  }
}

glm::dvec4 clipOf(const shared::ShadowView& view, const glm::dvec3& p) { return glm::dmat4(view.viewProjection) * glm::dvec4(p, 1.0); }
bool sees(const shared::ShadowView& view, const glm::dvec3& p, double margin = 0) {
  const glm::dvec4 clip = clipOf(view, p);
  return clip.w > 0 && std::max(std::abs(clip.x), std::abs(clip.y)) < clip.w * (1 + margin);
}

/// Direction through a texel's centre, and the solid angle of that texel by its definition.
void texelRay(const shared::ShadowView& view, uint32_t x, uint32_t y, glm::dvec3& direction, double& solidAngle) {
  // Depth 0 is infinitely far: a direction, without the cancellation of a difference of points.
  const auto at = [&](double i, double j) {
    return glm::normalize(
        glm::dvec3(glm::dmat4(view.inverseViewProjection) * glm::dvec4(i / view.resolution * 2 - 1, j / view.resolution * 2 - 1, 0, 1)));
  };
  direction = at(x + 0.5, y + 0.5);
  const double cosine = glm::dot(direction, at(view.resolution * 0.5, view.resolution * 0.5));
  solidAngle = view.texelFlux * cosine * cosine * cosine;
}

LightOptions smallMaps() {
  LightOptions options;
  options.shadowResolution = 64;
  options.pointShadowResolution = 64;
  options.emitterShadowResolution = 64;
  return options;
}

TEST(DirectionalTest, MapHoldsTheSceneTightly) {
  for (const glm::vec3 direction : {glm::vec3(0, -1, 0), glm::vec3(0.48f, -1, 0.42f), glm::vec3(1, 0, 0), glm::vec3(-0.3f, -0.1f, 0.9f)}) {
    Scene s = loadScene("builtin:two_rooms");
    s.lights.assign(1, PunctualLight());
    s.lights[0].direction = glm::normalize(direction);
    s.lights[0].intensity = glm::vec3(3);
    const LightSetup setup = setUpLights(s, LightOptions());
    expectConsistent(setup);
    ASSERT_EQ(setup.views.size(), 1u);
    const auto& view = setup.views[0];
    EXPECT_EQ(view.resolution, 2048u);
    EXPECT_EQ(setup.lights[0].intensity, glm::vec3(3));
    double widest = 0;
    for (const auto& vertex : s.vertices) {
      const glm::dvec4 clip = clipOf(view, glm::dvec3(vertex.position));
      EXPECT_NEAR(clip.w, 1, 1e-6);
      EXPECT_GT(clip.z, 0);
      EXPECT_LT(clip.z, 1);
      widest = std::max({widest, std::abs(clip.x), std::abs(clip.y)});
    }
    EXPECT_LE(widest, 1);
    EXPECT_GT(widest, 1 - 2.0 / 2048);  // half a texel of margin
    // What is nearer to the light has the larger depth.
    const glm::dvec3 p(4, 1, 2);
    EXPECT_GT(clipOf(view, p - glm::dvec3(direction) * 0.1).z, clipOf(view, p).z);
    // Two neighbouring texels are the square root of texelFlux apart, square to the light.
    const auto at = [&](double i, double j) {
      return glm::dvec3(glm::dmat4(view.inverseViewProjection) * glm::dvec4(i / 1024 - 1, j / 1024 - 1, 0.5, 1));
    };
    const glm::dvec3 dx = at(901, 100) - at(900, 100), dy = at(900, 101) - at(900, 100);
    EXPECT_NEAR(glm::length(glm::cross(dx, dy)) / view.texelFlux, 1, 1e-2);
    EXPECT_LT(std::abs(glm::dot(glm::normalize(dx), glm::dvec3(glm::normalize(direction)))), 1e-2);
  }
}

TEST(DirectionalTest, FlatSceneEdgeOn) {
  Scene s = loadScene("builtin:plane");
  s.lights[0].direction = {1, 0, 0};
  const LightSetup setup = setUpLights(s, LightOptions());
  for (const auto& vertex : s.vertices) EXPECT_TRUE(sees(setup.views[0], glm::dvec3(vertex.position)));
  EXPECT_TRUE(std::isfinite(setup.views[0].texelFlux));
}

TEST(PointTest, SixViewsShareTheSphereOut) {
  const Scene s = loadScene("builtin:cornell_point");
  const LightSetup setup = setUpLights(s, smallMaps());
  expectConsistent(setup);
  ASSERT_EQ(setup.views.size(), 6u);
  double total = 0;
  glm::dvec3 mean(0.0);
  for (const auto& view : setup.views) {
    for (uint32_t y = 0; y < 64; ++y) {
      for (uint32_t x = 0; x < 64; ++x) {
        glm::dvec3 d;
        double solidAngle = 0;
        texelRay(view, x, y, d, solidAngle);
        total += solidAngle;
        mean += d * solidAngle;
        int seenBy = 0;
        for (const auto& other : setup.views) seenBy += sees(other, glm::dvec3(view.origin) + d) ? 1 : 0;
        ASSERT_EQ(seenBy, 1);
      }
    }
  }
  EXPECT_NEAR(total, 4 * kPi, 2e-3);
  EXPECT_LT(glm::length(mean), 1e-4);
  // Points on the edges between faces belong to somebody.
  for (const glm::dvec3 d : {glm::dvec3(1, 1, 0), glm::dvec3(1, 1, 1), glm::dvec3(-1, 0, 1)}) {
    int seenBy = 0;
    for (const auto& view : setup.views) seenBy += sees(view, glm::dvec3(view.origin) + d, 1e-5) ? 1 : 0;
    EXPECT_GE(seenBy, 1);
  }
}

TEST(SpotTest, OneViewForNarrowFiveForWide) {
  Scene s = loadScene("builtin:cornell_point");
  s.lights[0].type = shared::kLightSpot;
  s.lights[0].direction = glm::normalize(glm::vec3(0.2f, -1, 0.3f));
  for (const float outer : {0.1f, 0.6f, 1.04f, 1.2f, 1.57f}) {
    s.lights[0].innerConeAngle = outer * 0.5f;
    s.lights[0].outerConeAngle = outer;
    const LightSetup setup = setUpLights(s, smallMaps());
    expectConsistent(setup);
    EXPECT_EQ(setup.lights[0].shadowViewCount, outer < 1.05f ? 1u : 5u);
    // Every direction of the cone is in exactly one view (but for seams).
    const glm::dvec3 axis(s.lights[0].direction), side = glm::normalize(glm::cross(axis, {0, 0, 1})), other = glm::cross(axis, side);
    for (int i = 0; i < 500; ++i) {
      const double a = outer * 0.998 * std::sqrt((i + 0.5) / 500), b = 2.399963 * i;
      const glm::dvec3 d = axis * std::cos(a) + (side * std::cos(b) + other * std::sin(b)) * std::sin(a);
      int seenBy = 0;
      for (const auto& view : setup.views) seenBy += sees(view, glm::dvec3(view.origin) + d) ? 1 : 0;
      EXPECT_EQ(seenBy, 1) << outer << " " << a << " " << b;
    }
  }
}

TEST(EmitterTest, QuadIsSampledEvenly) {
  const Scene s = loadScene("builtin:cornell");
  const LightSetup setup = setUpLights(s, LightOptions());
  expectConsistent(setup);
  ASSERT_EQ(setup.lights.size(), 32u);
  EXPECT_EQ(setup.emitterSampleCount, 32u);
  EXPECT_EQ(setup.views.size(), 160u);
  ASSERT_EQ(setup.emissive.size(), 2u);
  EXPECT_FLOAT_EQ(setup.emissive[0].cumulativePower, 0.5f);
  EXPECT_EQ(setup.emissive[1].cumulativePower, 1.f);
  EXPECT_EQ(setup.emissive[0].emission, glm::vec3(17, 12, 4));
  size_t first = 0;
  glm::dvec3 total(0.0), mean(0.0);
  double nearest = 1e9;
  for (const auto& light : setup.lights) {
    EXPECT_EQ(light.type, shared::kLightEmitterSample);
    EXPECT_LT(glm::length(light.direction - glm::vec3(0, -1, 0)), 1e-6f);
    EXPECT_LT(light.position.y, 5.49f);  // lifted off its front
    EXPECT_GT(light.position.y, 5.489f);
    EXPECT_GT(light.position.x, 2.1f);
    EXPECT_LT(light.position.x, 3.4f);
    EXPECT_GT(light.position.z, 2.2f);
    EXPECT_LT(light.position.z, 3.3f);
    first += light.triangle == setup.emissive[0].triangle ? 1 : 0;
    total += glm::dvec3(light.intensity);
    mean += glm::dvec3(light.position) / 32.0;
    for (const auto& other : setup.lights) {
      if (&other != &light) nearest = std::min(nearest, static_cast<double>(glm::length(other.position - light.position)));
    }
  }
  EXPECT_EQ(first, 16u);
  EXPECT_LT(glm::length(total - glm::dvec3(17, 12, 4) * 1.43), 1e-4);
  EXPECT_LT(glm::length(mean - glm::dvec3(2.75, 5.49, 2.75)), 0.03);
  EXPECT_GT(nearest, 0.25 * std::sqrt(1.43 / 32));  // no two in one place
}

TEST(EmitterTest, ViewsCoverTheFrontHemisphere) {
  const Scene s = loadScene("builtin:cornell");
  LightOptions options = smallMaps();
  options.emitterSamples = 1;
  const LightSetup setup = setUpLights(s, options);
  ASSERT_EQ(setup.views.size(), 5u);
  double cosines = 0;
  for (const auto& view : setup.views) {
    for (uint32_t y = 0; y < view.resolution; ++y) {
      for (uint32_t x = 0; x < view.resolution; ++x) {
        glm::dvec3 d;
        double solidAngle = 0;
        texelRay(view, x, y, d, solidAngle);
        cosines += std::max(0.0, glm::dot(d, glm::dvec3(setup.lights[0].direction))) * solidAngle;
      }
    }
  }
  EXPECT_NEAR(cosines, kPi, 2e-3);
}

/// Lamps of many sizes and colours: each colour's power arrives in full, whatever the number of samples.
TEST(EmitterTest, PowerIsKeptColourByColour) {
  Scene s = loadScene("builtin:plane?subdivisions=16&size=10");
  s.lights.clear();
  s.materials.resize(4, s.materials[0]);
  s.materialNames.resize(4);
  const glm::vec3 colours[3] = {{10, 0.1f, 0}, {0, 3, 0.5f}, {0, 0, 40}};
  for (size_t k = 0; k < 3; ++k) {
    s.materials[k + 1].emission = colours[k];
    s.materials[k + 1].flags |= shared::kMaterialEmissive;
  }
  for (size_t t = 0; t < 45; ++t) s.triangleMaterials[t * 11] = static_cast<uint32_t>(t % 3 + 1);
  glm::dvec3 expected(0.0);
  for (size_t t = 0; t < s.triangleCount(); ++t)
    expected += glm::dvec3(s.materials[s.triangleMaterials[t]].emission) * (0.5 * glm::length(scene::areaVector(s, t)));
  for (const uint32_t samples : {1u, 7u, 32u, 100u, 1000u}) {
    LightOptions options = smallMaps();
    options.emitterSamples = samples;
    options.emitterShadowResolution = 16;
    const LightSetup setup = setUpLights(s, options);
    ASSERT_EQ(setup.emitterSampleCount, samples);
    glm::dvec3 total(0.0);
    for (const auto& light : setup.lights) {
      total += glm::dvec3(light.intensity);
      EXPECT_NE(s.materials[s.triangleMaterials[light.triangle]].flags & shared::kMaterialEmissive, 0u);
    }
    for (glm::length_t c = 0; c < 3; ++c) EXPECT_NEAR(total[c] / expected[c], 1, 1e-5) << samples;
    EXPECT_EQ(setup.emissive.size(), 45u);
    for (size_t i = 1; i < setup.emissive.size(); ++i) EXPECT_GT(setup.emissive[i].cumulativePower, setup.emissive[i - 1].cumulativePower);
  }
}

TEST(EmitterTest, ByRaysWhenMuchEmitsOrNoSamplesAreWanted) {
  const Scene furnace = loadScene("builtin:furnace");
  const LightSetup all = setUpLights(furnace, LightOptions());
  EXPECT_TRUE(all.lights.empty());
  EXPECT_TRUE(all.views.empty());
  EXPECT_EQ(all.emissive.size(), 12u);
  EXPECT_EQ(all.emitterSampleCount, 0u);
  EXPECT_EQ(all.shadowResolution, 1u);
  EXPECT_EQ(all.shadowLayers, 1u);
  EXPECT_TRUE(scene::traitsFor(furnace, LightOptions()).emittersByRays);
  LightOptions none;
  none.emitterSamples = 0;
  const Scene cornell = loadScene("builtin:cornell");
  EXPECT_TRUE(setUpLights(cornell, none).lights.empty());
  EXPECT_TRUE(scene::traitsFor(cornell, none).emittersByRays);
  EXPECT_FALSE(scene::traitsFor(cornell, LightOptions()).emittersByRays);
  EXPECT_FALSE(scene::traitsFor(loadScene("builtin:box"), none).emittersByRays);
}

// Views without texels are those that no triangle is in: points of triangles say which must have some.
TEST(LightSetupTest, ViewsThatNoFaceIsInHaveNoTexels) {
  uint32_t state = 7;
  const auto random = [&state] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 16777216.f;
  };
  uint32_t darkCount = 0, litCount = 0;
  for (int round = 0; round < 30; ++round) {
    Scene s = loadScene("builtin:empty");
    s.materials.resize(1);
    const int triangles = 1 + static_cast<int>(random() * 200);
    const glm::vec3 middle(random() * 8 - 4, random() * 8 - 4, random() * 8 - 4);
    for (int t = 0; t < triangles; ++t) {
      const glm::vec3 at = middle + glm::vec3(random(), random(), random());
      for (int k = 0; k < 3; ++k) {
        s.indices.push_back(static_cast<uint32_t>(s.vertices.size()));
        s.vertices.emplace_back().position = at + 0.5f * glm::vec3(random(), random(), random());
      }
      s.triangleMaterials.push_back(0);
    }
    PunctualLight lamp;
    lamp.intensity = glm::vec3(1);
    lamp.type = round % 2 == 0 ? shared::kLightPoint : shared::kLightSpot;
    lamp.direction = glm::normalize(glm::vec3(random() - 0.5f, random() - 0.5f, random() - 0.5f));
    lamp.innerConeAngle = 0.1f;
    lamp.outerConeAngle = 0.2f + 1.3f * random();
    s.lights = {lamp};
    LightOptions options;
    options.fixed = true;
    const LightSetup setup = setUpLights(s, options);
    LightOptions all = options;
    all.kept = scene::kKeepAll;
    const LightSetup whole = setUpLights(s, all);
    expectSoundTiles(setup);
    EXPECT_EQ(setup.wholeShadowSide, whole.shadowResolution);
    ASSERT_EQ(setup.views.size(), whole.views.size());
    uint32_t dark = 0;
    for (size_t v = 0; v < setup.views.size(); ++v) {
      EXPECT_GT(whole.views[v].resolution, 0u);
      bool seen = false, nearlySeen = false;
      for (size_t t = 0; t < s.triangleCount(); ++t) {
        for (int i = 0; i <= 8; ++i) {
          for (int j = 0; j <= 8 - i; ++j) {
            const auto corner = [&](size_t k) { return glm::dvec3(s.vertices[s.indices[3 * t + k]].position); };
            const glm::dvec3 p = corner(0) + (corner(1) - corner(0)) * (i / 8.0) + (corner(2) - corner(0)) * (j / 8.0);
            seen = seen || sees(setup.views[v], p);
            nearlySeen = nearlySeen || sees(setup.views[v], p, 0.3);
          }
        }
      }
      EXPECT_FALSE(seen && setup.views[v].resolution == 0);
      // Triangles of half a metre: the plane test takes a few for seen that pass beside a corner of the view.
      EXPECT_FALSE(!nearlySeen && s.triangleCount() < 20 && setup.views[v].resolution > 0);
      dark += setup.views[v].resolution == 0 ? 1 : 0;
    }
    EXPECT_EQ(dark, setup.darkViewCount);
    darkCount += dark;
    litCount += static_cast<uint32_t>(setup.views.size()) - dark;
  }
  EXPECT_GT(darkCount, 20u);
  EXPECT_GT(litCount, 20u);
}

TEST(LightSetupTest, LightsThatEndBeforeTheSceneReachNothing) {
  Scene s = loadScene("builtin:box");
  LightOptions options;
  options.fixed = true;
  s.lights.assign(1, PunctualLight());
  s.lights[0].type = shared::kLightPoint;
  s.lights[0].intensity = glm::vec3(1);
  s.lights[0].position = glm::vec3(s.traits().boundsMax) + glm::vec3(1.f, 0.f, 0.f);
  for (const auto& [range, reaches] : {std::pair{0.f, true}, {0.99f, false}, {1.01f, true}}) {
    s.lights[0].range = range;
    const scene::Traits traits = scene::traitsFor(s, options);
    EXPECT_EQ(traits.punctualLightCount(), reaches ? 1u : 0u) << range;
    EXPECT_EQ(traits.whyNothingBounces() == nullptr, reaches) << range;
    EXPECT_EQ(scene::traitsFor(s, LightOptions()).punctualLightCount(), 1u) << "it may be moved";
  }
  s.lights[0].intensity = glm::vec3(0);
  EXPECT_EQ(scene::traitsFor(s, options).punctualLightCount(), 0u);
}

TEST(LightSetupTest, EmptyAndDarkScenes) {
  Scene s = loadScene("builtin:empty");
  s.lights.resize(1);
  s.lights[0].intensity = glm::vec3(1);
  const LightSetup empty = setUpLights(s, LightOptions());
  EXPECT_EQ(empty.lights.size(), 1u);
  EXPECT_EQ(empty.lights[0].shadowViewCount, 0u);
  EXPECT_TRUE(empty.views.empty());
  Scene dark = loadScene("builtin:box");
  dark.lights.clear();
  EXPECT_TRUE(setUpLights(dark, LightOptions()).lights.empty());
}

TEST(LightSetupTest, SameBitsEachTime) {
  const Scene s = loadScene("builtin:cornell");
  const LightSetup a = setUpLights(s, LightOptions()), b = setUpLights(s, LightOptions());
  ASSERT_EQ(a.lights.size(), b.lights.size());
  EXPECT_EQ(std::memcmp(a.lights.data(), b.lights.data(), a.lights.size() * sizeof(shared::Light)), 0);
  EXPECT_EQ(std::memcmp(a.views.data(), b.views.data(), a.views.size() * sizeof(shared::ShadowView)), 0);
}

TEST(BudgetTest, CornellTilesFillAFewLayers) {
  const LightSetup setup = setUpLights(loadScene("builtin:cornell"), LightOptions());
  EXPECT_EQ(setup.views[0].resolution, 256u);
  EXPECT_EQ(setup.views[1].resolution, 128u);  // sides get less: half of each is behind the emitter
  // 32·256² + 128·128² texels: one layer of 2048² holds them exactly.
  EXPECT_EQ(setup.shadowResolution, 2048u);
  EXPECT_EQ(setup.shadowLayers, 1u);
  EXPECT_TRUE(setup.notes.empty());
}

TEST(BudgetTest, ResolutionsFallBeforeAnythingIsLeftOut) {
  Scene s = loadScene("builtin:cornell_point");
  s.lights.resize(40, s.lights[0]);  // 240 faces of 1024²: 2 GiB
  LightOptions options;
  const LightSetup setup = setUpLights(s, options);
  expectSoundTiles(setup);
  EXPECT_EQ(setup.lights.size(), 40u);
  EXPECT_EQ(setup.views[0].resolution, 512u);
  EXPECT_LE(8ull * setup.shadowResolution * setup.shadowResolution * setup.shadowLayers, options.maxShadowBytes);
  ASSERT_EQ(setup.notes.size(), 1u);
  EXPECT_EQ(setup.notes[0], "shadow resolution of point lights lowered from 1024 to 512 so that all shadow maps fit");
}

TEST(BudgetTest, EmitterSamplesFallThen) {
  const Scene s = loadScene("builtin:cornell");
  LightOptions options;
  options.emitterSamples = 1000;
  options.maxShadowBytes = 4ull << 20;  // 2^19 texels: 64 samples of 64² + 4·32² fit
  const LightSetup setup = setUpLights(s, options);
  expectSoundTiles(setup);
  EXPECT_LE(8ull * setup.shadowResolution * setup.shadowResolution * setup.shadowLayers, options.maxShadowBytes);
  EXPECT_GE(setup.emitterSampleCount, 31u);
  EXPECT_LE(setup.emitterSampleCount, 64u);
  EXPECT_EQ(setup.notes.size(), 2u);
}

TEST(BudgetTest, RefusesWithTheNumberThatFits) {
  Scene s = loadScene("builtin:cornell_point");
  s.lights.resize(3000, s.lights[0]);
  const Error error = catchError([&] { setUpLights(s, LightOptions()); });
  expectError(error, ErrorCode::OutOfMemory, "shadow maps of 3000 lights do not fit into 512 MiB");
  // That many do fit, and not one more.
  const std::string text = error.what();
  const size_t end = text.find(" of them fit"), start = text.rfind(' ', end - 1) + 1;
  const size_t fitting = std::stoul(text.substr(start, end - start));
  s.lights.resize(fitting);
  expectSoundTiles(setUpLights(s, LightOptions()));
  s.lights.resize(fitting + 1, s.lights[0]);
  EXPECT_THROW(setUpLights(s, LightOptions()), Error);
}

TEST(BudgetTest, AnyMixOfResolutionsPacks) {
  Scene s = loadScene("builtin:cornell");
  s.lights.resize(7);
  for (size_t i = 0; i < s.lights.size(); ++i) {
    s.lights[i].type = static_cast<uint32_t>(i % 3);
    s.lights[i].intensity = glm::vec3(1);
    s.lights[i].position = {2, 3, 2};
    s.lights[i].outerConeAngle = i == 2 ? 0.4f : 1.5f;
  }
  LightOptions options;
  options.shadowResolution = 1000;
  options.pointShadowResolution = 333;
  options.emitterShadowResolution = 77;
  expectConsistent(setUpLights(s, options));
  options.maxShadowSide = 1000;
  expectConsistent(setUpLights(s, options));
  options.maxShadowSide = 500;  // a device with small images
  const LightSetup small = setUpLights(s, options);
  expectConsistent(small);
  EXPECT_LE(small.shadowResolution, 500u);
}

}  // namespace
}  // namespace radivox::tests
