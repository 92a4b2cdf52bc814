// Things that move: with visibility.keep only rays that pass what has changed are traced again, and the result is that of a run from scratch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "engine/scene/builtin.h"
#include "modules/clustered_voxel/visibility/kept_hits.h"
#include "shaders/shared/voxel_codec.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace {

using namespace radivox;
using oracles::Pipeline;
using oracles::PipelineOptions;
using Settings = std::vector<std::pair<std::string, std::string>>;

constexpr uint32_t kBlockVertices = 24;

/// A block of 0.5 m about the origin, behind the scene's other vertices.
uint32_t addBlock(scene::Scene& s) {
  const auto first = static_cast<uint32_t>(s.vertices.size());
  for (uint32_t f = 0; f < 6; ++f) {
    const glm::vec3 n = shared::faceVector(f);
    const glm::vec3 u(n.y, n.z, n.x), v = glm::cross(n, u);
    const auto corner = static_cast<uint32_t>(s.vertices.size());
    for (const glm::vec2 at : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
      shared::Vertex vertex{};
      vertex.position = 0.25f * (n + at.x * u + at.y * v);
      vertex.normal = n;
      s.vertices.push_back(vertex);
    }
    for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) s.indices.push_back(corner + i);
    s.triangleMaterials.insert(s.triangleMaterials.end(), 2, 0u);
  }
  return first;
}

class Moving : public oracles::GpuTest {
 protected:
  /// Everything that the picture follows from.
  struct Result {
    std::vector<uint32_t> rows, entries, weights, labels;
    std::vector<float> color;
    bool operator==(const Result&) const = default;
  };
  Result resultOf(Pipeline& p) {
    Result r;
    r.rows = p.buffer<uint32_t>("visibility.row_start");
    r.weights = p.buffer<uint32_t>("visibility.weights", p.count("faces"));
    r.labels = p.buffer<uint32_t>("cluster.labels", p.count("faces"));
    for (const gpu::Buffer* chunk : p.executor->findGrown("visibility.entries")) {
      const auto words = gpu::downloadAs<uint32_t>(device(), *chunk, chunk->bytes() / 4);
      r.entries.insert(r.entries.end(), words.begin(), words.end());
    }
    r.color = p.picture("composite.color").data;
    return r;
  }
  static PipelineOptions options(const Settings& settings, const std::string& graph) {
    PipelineOptions o;
    o.graph = graph;
    o.settings = settings;
    o.outputs = {"composite.color", "visibility.row_start", "visibility.weights", "cluster.labels"};
    return o;
  }
  /// Places the block here and there, and compares with pictures from scratch. Returns the mean share of rays traced.
  double moveAbout(const Settings& settings, const std::string& graph = "clustered_voxel_pixels", size_t placeCount = 2) {
    scene::Scene s = scene::makeBuiltin("cornell_point");
    const uint32_t block = addBlock(s);
    const scene::Scene atOrigin = s;
    const auto place = [&](const glm::mat4& by) {
      s = atOrigin;
      scene::moveVertices(s, block, kBlockVertices, by);
    };
    const glm::mat4 one(1.f);
    const glm::vec3 middle = 0.5f * (atOrigin.traits().boundsMin + atOrigin.traits().boundsMax);
    place(glm::translate(one, middle));
    Settings keeping = settings;
    keeping.emplace_back("visibility.keep", "true");
    Pipeline kept(device(), s, options(keeping, graph));
    kept.run();
    const Result first = resultOf(kept);
    EXPECT_EQ(first, resultFromScratch(s, settings, graph));
    double share = 0;
    const std::vector<glm::mat4> places{
        glm::translate(one, middle + glm::vec3(0.35f, 0, 0)), glm::translate(one, middle + glm::vec3(-0.15f, 0.2f, 0.1f)),
        glm::rotate(glm::translate(one, middle), 0.7f, glm::vec3(0.6f, 0.8f, 0)), glm::translate(one, middle)};
    for (size_t i = 0; i < placeCount; ++i) {
      SCOPED_TRACE(i);
      place(places[i]);
      kept.setGeometry(s);
      kept.run();
      EXPECT_EQ(resultOf(kept), resultFromScratch(s, settings, graph));
      share += kept.figure("visibility", "traced_rays") / kept.figure("visibility", "rays") / static_cast<double>(placeCount);
    }
    place(places.back());
    kept.setGeometry(s);
    kept.run();
    EXPECT_EQ(resultOf(kept), first) << "back where it was";
    // Nothing moves.
    kept.setGeometry(s);
    kept.run();
    EXPECT_EQ(resultOf(kept), first);
    EXPECT_EQ(kept.figure("visibility", "traced_rays"), 0);
    EXPECT_EQ(kept.figure("visibility", "changed_voxels"), 0);
    return share;
  }

 private:
  Result resultFromScratch(const scene::Scene& s, const Settings& settings, const std::string& graph) {
    Pipeline fresh(device(), s, options(settings, graph));
    fresh.run();
    return resultOf(fresh);
  }
};

const Settings kSmall{{"voxelize.resolution", "40"}, {"visibility.rays", "16"}};

TEST_F(Moving, SlowABlockIsTracedAnewAndTheRestKept) {
  const double share = moveAbout(kSmall, "clustered_voxel_pixels", 3);
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.7);
}

TEST_F(Moving, SlowEveryKindOfRay) {
  const auto with = [](Settings more) {
    more.insert(more.begin(), kSmall.begin(), kSmall.end());
    return more;
  };
  const std::vector<Settings> kinds{
      {{"visibility.triangles", "0"}},
      {{"visibility.rays", "100"}, {"visibility.skip", "bricks"}},
      {{"visibility.triangles", "0"}, {"visibility.rays", "100"}, {"visibility.near", "0"}},
      {{"visibility.triangles", "0"}, {"visibility.traversal", "bresenham"}, {"visibility.frame", "axis"}, {"visibility.hit", "voxel"}},
      {{"visibility.triangles", "3"}, {"triangles.most", "2"}},
  };
  for (size_t k = 0; k < kinds.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_LT(moveAbout(with(kinds[k]), "clustered_voxel_pixels", 1), 0.7);
  }
}

TEST_F(Moving, SlowTheFaceReceiverToo) { EXPECT_LT(moveAbout(kSmall, "clustered_voxel", 1), 0.7); }

// gather_pixels.keep: the picture is the same bit for bit, and light that moves traces no ray of a pixel.
TEST_F(Moving, SlowLightTracesNoRayOfAPixel) {
  struct Kind {
    const char* name;
    const char* scene;
    Settings settings;
    scene::LightOptions lights;
    const char* sky = "";
  };
  scene::LightOptions byRays;
  byRays.emitterSamples = 0;
  const Kind kinds[] = {{"near hits look their light up", "cornell_point", {{"gather_pixels.rays", "10"}}, {}},
                        {"triangles all the way", "cornell_point", {{"gather_pixels.near", "4096"}, {"gather_pixels.smooth", "0"}}, {}},
                        {"no triangles", "cornell_point", {{"gather_pixels.near", "0"}}, {}},
                        {"sun and even sky", "atrium?triangles=3000", {{"gather_pixels.rays", "5"}}, {}},
                        {"sky's image", "atrium?triangles=3000", {{"gather_pixels.rays", "50"}}, {}, "builtin:clear"},
                        {"emitters by rays", "cornell", {}, byRays}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.name);
    scene::Scene s = scene::loadScene(std::string("builtin:") + kind.scene, kind.sky);
    PipelineOptions o = options(kSmall, "clustered_voxel_pixels");
    o.settings.insert(o.settings.end(), kind.settings.begin(), kind.settings.end());
    o.lights = kind.lights;
    Pipeline fresh(device(), s, o);
    o.settings.emplace_back("gather_pixels.keep", "true");
    Pipeline kept(device(), s, o);
    const auto expectSame = [&](bool traces) {
      fresh.run();
      kept.run();
      EXPECT_EQ(kept.picture("composite.color").data, fresh.picture("composite.color").data);
      EXPECT_EQ(kept.figure("gather_pixels", "traced_rays"), traces ? kept.figure("gather_pixels", "rays") : 0.0);
    };
    expectSame(true);
    const std::vector<float> before = kept.picture("composite.color").data;
    scene::Scene moved = s;
    for (scene::PunctualLight& light : moved.lights) {
      light.position += glm::vec3(0.1f, 0.f, 0.05f);
      light.direction = glm::normalize(light.direction + glm::vec3(0.2f, 0.f, 0.1f));
      light.intensity *= 1.25f;
    }
    if (!moved.lights.empty()) {
      kept.setLights(moved);
      fresh.setLights(moved);
      expectSame(false);
      EXPECT_NE(kept.picture("composite.color").data, before);
    }
    scene::CameraDescription camera = s.cameras.front();
    camera.position += glm::vec3(0.05f, 0.02f, 0.f);
    kept.setCamera(camera);
    fresh.setCamera(camera);
    expectSame(true);
  }
}

// More hits than a storage buffer's binding shows on CPU devices.
TEST_F(Moving, SlowManyHitsAreKept) {
  PipelineOptions o = options(kSmall, "clustered_voxel_pixels");
  o.width = 320;
  o.height = 216;
  o.settings.insert(o.settings.end(), {{"voxelize.resolution", "16"}, {"gather_pixels.rays", "250"}, {"gather_pixels.near", "0"}});
  scene::Scene s = scene::makeBuiltin("cornell_point");
  Pipeline fresh(device(), s, o);
  fresh.run();
  o.settings.emplace_back("gather_pixels.keep", "true");
  Pipeline kept(device(), s, o);
  kept.run();
  ASSERT_GT(kept.executor->findBuffer("gather_pixels.hits")->bytes(), 128u << 20);
  kept.setLights(s);
  kept.run();
  EXPECT_EQ(kept.figure("gather_pixels", "traced_rays"), 0);
  EXPECT_EQ(kept.picture("composite.color").data, fresh.picture("composite.color").data);
}

TEST_F(Moving, WhatDoesNotFitIsRefused) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  scene::GpuScene onDevice(device(), s);
  const scene::Scene before = s;
  addBlock(s);
  EXPECT_THROW(onDevice.setGeometry(s), Error);
  s = before;
  const auto all = static_cast<uint32_t>(s.vertices.size());
  EXPECT_THROW(scene::moveVertices(s, 1, all, glm::mat4(1.f)), Error);
  EXPECT_THROW(scene::moveVertices(s, 0, all, glm::scale(glm::mat4(1.f), glm::vec3(-1, 1, 1))), Error);
  EXPECT_THROW(scene::moveVertices(s, 0, all, glm::scale(glm::mat4(1.f), glm::vec3(0, 1, 1))), Error);
  EXPECT_THROW(scene::moveVertices(s, 0, all, glm::translate(glm::mat4(1.f), glm::vec3(NAN, 0, 0))), Error);
  for (uint32_t i = 0; i < all; ++i) EXPECT_EQ(s.vertices[i].position, before.vertices[i].position);
  scene::moveVertices(s, 0, all, glm::scale(glm::translate(glm::mat4(1.f), glm::vec3(1, 0, 0)), glm::vec3(2, 1, 1)));
  for (uint32_t i = 0; i < all; ++i) {
    EXPECT_NEAR(s.vertices[i].position.x, 2 * before.vertices[i].position.x + 1, 1e-5);
    EXPECT_NEAR(glm::length(s.vertices[i].normal), 1, 1e-5);
  }
}

// Boxes hold every changed voxel, and two small changes far apart do not become one large one.
TEST(WrapChanges, BoxesHoldAllAndLittleElse) {
  shared::Grid grid{};
  grid.size = {100, 60, 40};
  grid.bricks = {25, 15, 10};
  grid.brickCount = 25 * 15 * 10;
  std::mt19937 random(7);
  EXPECT_TRUE(clustered_voxel::wrapChanges(grid, std::vector<uint32_t>(2 * grid.brickCount)).empty());
  for (const uint32_t count : {1u, 2u, 40u, 3000u}) {
    std::vector<uint32_t> changed(2 * grid.brickCount);
    std::vector<glm::uvec3> voxels;
    for (uint32_t i = 0; i < count; ++i) {
      const glm::uvec3 v(static_cast<uint32_t>(random() % grid.size.x), static_cast<uint32_t>(random() % grid.size.y),
                         static_cast<uint32_t>(random() % grid.size.z));
      const uint32_t bit = shared::bitOf(v);
      changed[2 * shared::brickOf(v, grid.bricks) + (bit >> 5)] |= 1u << (bit & 31u);
      voxels.push_back(v);
    }
    const auto boxes = clustered_voxel::wrapChanges(grid, changed);
    EXPECT_LE(boxes.size(), shared::kMostChangedBoxes);
    for (const glm::uvec3& v : voxels) {
      const glm::vec3 p(v);
      EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const shared::ChangedBox& box) {
        return glm::all(glm::lessThanEqual(box.least, p)) && glm::all(glm::greaterThanEqual(box.greatest, p));
      }));
    }
  }
  std::vector<uint32_t> corners(2 * grid.brickCount);
  corners.front() = 1;
  corners.back() = 0x80000000u;
  EXPECT_EQ(clustered_voxel::wrapChanges(grid, corners).size(), 2u);
}

}  // namespace
