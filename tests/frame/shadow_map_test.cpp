// Shadow maps against rays through their texels.
#include <gtest/gtest.h>

#include <random>

#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/light_oracle.h"

namespace radivox {
namespace {

using frame_test::FrameOptions;
using frame_test::FrameRun;
using frame_test::SceneBuilder;

class ShadowMapTest : public oracles::GpuTest {};

FrameOptions shadowOnly() {
  FrameOptions options;
  options.width = options.height = 8;
  options.outputs = {"shadow_map.depth", "shadow_map.triangle"};
  options.lights.shadowResolution = 128;
  options.lights.pointShadowResolution = 64;
  options.lights.emitterSamples = 4;
  options.lights.emitterShadowResolution = 32;
  return options;
}

/// A room without a lid, boxes in it, triangles above.
SceneBuilder makeRoom() {
  SceneBuilder b;
  b.addQuad({-4.f, 0.f, 4.f}, {4.f, 0.f, 4.f}, {4.f, 0.f, -4.f}, {-4.f, 0.f, -4.f});
  b.addQuad({-4.f, 0.f, -4.f}, {4.f, 0.f, -4.f}, {4.f, 5.f, -4.f}, {-4.f, 5.f, -4.f});
  b.addBox({-2.f, 0.f, -1.f}, {-1.f, 2.f, 1.f});
  b.addBox({0.5f, 0.f, 0.5f}, {2.f, 1.f, 2.f});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.f, 1.f);
  for (int i = 0; i < 20; ++i) {
    glm::vec3 corner[3];
    const float x = 3.f * unit(random), y = 2.5f + unit(random), z = 3.f * unit(random);
    for (glm::vec3& c : corner) {
      const float dx = unit(random), dy = unit(random), dz = unit(random);
      c = glm::vec3(x, y, z) + 0.6f * glm::vec3(dx, dy, dz);
    }
    b.addTriangle(corner[0], corner[1], corner[2]);
  }
  b.lookAt({0.f, 3.f, 8.f}, {0.f, 0.f, 0.f});
  return b;
}

/// Every texel of every view: id and depth of what the ray through its centre meets first. Returns how many texels were compared.
size_t compareWithRays(FrameRun& run, const SceneBuilder& b, const scene::LightOptions& lights) {
  const scene::LightSetup setup = scene::setUpLights(b.scene, lights);
  const oracles::LightOracle rays(b.scene);
  std::vector<std::vector<uint32_t>> ids;
  std::vector<std::vector<float>> depths;
  for (uint32_t layer = 0; layer < setup.shadowLayers; ++layer) {
    ids.push_back(run.words("shadow_map.triangle", layer));
    depths.push_back(run.depths("shadow_map.depth", layer));
  }
  std::vector<std::vector<bool>> owned(setup.shadowLayers, std::vector<bool>(size_t{setup.shadowResolution} * setup.shadowResolution));
  size_t compared = 0, hits = 0;
  for (const shared::ShadowView& view : setup.views) {
    const glm::dmat4 inverse = glm::inverse(glm::dmat4(view.viewProjection));
    const auto unproject = [&](double x, double y, double z) {
      const glm::dvec4 p = inverse * glm::dvec4(x, y, z, 1);
      return glm::dvec3(p) / p.w;
    };
    for (uint32_t y = 0; y < view.resolution; ++y) {
      for (uint32_t x = 0; x < view.resolution; ++x) {
        const size_t at = size_t{view.offsetY + y} * setup.shadowResolution + view.offsetX + x;
        EXPECT_FALSE(owned[view.layer][at]) << "two views share a texel";
        owned[view.layer][at] = true;
        const auto cast = [&](double dx, double dy) {
          const double ndcX = 2 * (x + 0.5 + dx) / view.resolution - 1, ndcY = 2 * (y + 0.5 + dy) / view.resolution - 1;
          const glm::dvec3 near = unproject(ndcX, ndcY, 1);
          const glm::dvec3 direction = glm::normalize(unproject(ndcX, ndcY, 0.5) - near);
          return std::make_pair(rays.castRay(near, direction), std::make_pair(near, direction));
        };
        const auto [hit, ray] = cast(0, 0);
        bool certain = true;
        for (const auto& [dx, dy] : {std::pair{0.02, 0.}, {-0.02, 0.}, {0., 0.02}, {0., -0.02}}) {
          const auto other = cast(dx, dy).first;
          certain = certain && other.has_value() == hit.has_value() && (!hit || other->triangle == hit->triangle);
        }
        if (!certain) continue;
        ++compared;
        EXPECT_EQ(ids[view.layer][at], hit ? hit->triangle + 1 : 0u) << "light " << view.light << " texel " << x << ", " << y;
        if (!hit) {
          EXPECT_EQ(depths[view.layer][at], 0.f);
          continue;
        }
        ++hits;
        const glm::dvec4 clip = glm::dmat4(view.viewProjection) * glm::dvec4(ray.first + hit->t * ray.second, 1);
        const double slope = std::abs(glm::dot(rays.normal(hit->triangle), ray.second));
        EXPECT_NEAR(depths[view.layer][at], clip.z / clip.w, 1e-4 * clip.z / clip.w / std::max(slope, 0.01));
      }
    }
  }
  for (uint32_t layer = 0; layer < setup.shadowLayers; ++layer)
    for (size_t i = 0; i < owned[layer].size(); ++i)
      if (!owned[layer][i]) {
        EXPECT_EQ(ids[layer][i], 0u) << "a draw left its tile";
      }
  EXPECT_GT(hits, compared / 10);
  return compared;
}

TEST_F(ShadowMapTest, SunSeesTheNearestSurface) {
  SceneBuilder b = makeRoom();
  b.addSun({0.3f, -1.f, 0.2f}, glm::vec3(1.f));
  const FrameOptions options = shadowOnly();
  FrameRun run(device(), b.scene, options);
  EXPECT_GT(compareWithRays(run, b, options.lights), 12000u);
}

TEST_F(ShadowMapTest, ManyLightsShareLayersTileByTile) {
  SceneBuilder b = makeRoom();
  b.addPoint({0.f, 2.f, 0.f}, glm::vec3(1.f));
  b.addPoint({3.f, 4.f, 3.f}, glm::vec3(1.f));
  b.addSpot({-3.f, 4.f, 3.f}, {0.6f, -1.f, -0.5f}, glm::vec3(1.f), 0.2f, 0.5f);
  b.addSun({-0.2f, -1.f, -0.4f}, glm::vec3(1.f));
  const uint32_t lamp = b.addMaterial(glm::vec3(0.5f), glm::vec3(4.f));
  b.addQuad({-1.f, 4.5f, -1.f}, {1.f, 4.5f, -1.f}, {1.f, 4.5f, 1.f}, {-1.f, 4.5f, 1.f}, lamp);
  const FrameOptions options = shadowOnly();
  const scene::LightSetup setup = scene::setUpLights(b.scene, options.lights);
  ASSERT_EQ(setup.emitterSampleCount, 4u);
  ASSERT_GT(setup.views.size(), setup.shadowLayers) << "the test wants several tiles in a layer";
  FrameRun run(device(), b.scene, options);
  EXPECT_GT(compareWithRays(run, b, options.lights), 60000u);
  EXPECT_EQ(run.figure("shadow_map", "views"), static_cast<double>(setup.views.size()));
}

TEST_F(ShadowMapTest, SidesAndMasks) {
  SceneBuilder b;
  // A sheet that shows the sun its back, above a floor.
  b.addQuad({-1.f, 1.f, -1.f}, {1.f, 1.f, -1.f}, {1.f, 1.f, 1.f}, {-1.f, 1.f, 1.f});
  b.addQuad({-1.f, 0.f, 1.f}, {1.f, 0.f, 1.f}, {1.f, 0.f, -1.f}, {-1.f, 0.f, -1.f});
  b.addSun({0.f, -1.f, 0.f}, glm::vec3(1.f));
  b.lookAt({0.f, 3.f, 8.f}, {0.f, 0.f, 0.f});
  const auto seen = [&](FrameOptions options) {
    std::vector<size_t> texels(5);
    for (const uint32_t id : FrameRun(device(), b.scene, options).words("shadow_map.triangle")) ++texels[id];
    return texels;
  };
  FrameOptions options = shadowOnly();
  auto both = seen(options);
  EXPECT_GT(both[1] + both[2], 0u);
  options.settings = {{"shadow_map.sides", "gltf"}};
  auto gltf = seen(options);
  EXPECT_EQ(gltf[1] + gltf[2], 0u);
  EXPECT_EQ(gltf[3] + gltf[4], both[1] + both[2] + both[3] + both[4]);
  // Likewise from a point.
  b.scene.lights.clear();
  b.addPoint({0.f, 3.f, 0.f}, glm::vec3(1.f));
  EXPECT_EQ(seen(options)[1], 0u);
  EXPECT_GT(seen(shadowOnly())[1], 0u);

  // A mask lets half of the light through.
  b.scene.lights.clear();
  b.addSun({0.f, -1.f, 0.f}, glm::vec3(1.f));
  scene::TextureImage stripes;
  stripes.name = "stripes";
  stripes.width = 8;
  stripes.height = 1;
  stripes.nearest = true;
  for (uint32_t i = 0; i < 8; ++i) stripes.rgba.insert(stripes.rgba.end(), {255, 255, 255, static_cast<uint8_t>(i % 2 == 0 ? 255 : 0)});
  b.scene.textures.push_back(stripes);
  const uint32_t masked = b.addMaterial(glm::vec3(0.5f), glm::vec3(0.f), shared::kMaterialAlphaMask);
  b.scene.materials[masked].baseTexture = 0;
  b.scene.triangleMaterials[0] = b.scene.triangleMaterials[1] = masked;
  const auto through = seen(shadowOnly());
  const double sheet = static_cast<double>(both[1] + both[2]);
  EXPECT_NEAR(static_cast<double>(through[1] + through[2]) / sheet, 0.5, 0.05);
  EXPECT_NEAR(static_cast<double>(through[3] + through[4]) / sheet, 0.5, 0.05);
}

}  // namespace
}  // namespace radivox
