// clustered_voxel.triangles against the separating-axis test in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>

#include "shaders/shared/voxel_codec.h"
#include "tests/clustered_voxel/voxel_run.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/voxel_oracle.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

constexpr double kDilationBound = 4e-5;  // of voxelize, documented in voxelize.h

class TrianglesTest : public oracles::GpuTest {};

struct Lists {
  shared::Grid grid{};
  std::vector<uint32_t> voxels, first, ids;
  std::vector<glm::uvec2> pieces;
};

Lists listsOf(const scene::Scene& scene, uint32_t resolution, const std::string& most = "256") {
  PipelineOptions options;
  options.graph = "clustered_voxel_pixels";
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}, {"triangles.most", most}};
  options.outputs = {"voxelize.grid", "index.voxels", "triangles.first", "triangles.ids", "triangles.pieces"};
  Pipeline p(oracles::sharedDevice(), scene, options);
  p.run();
  Lists lists;
  lists.grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
  lists.voxels = p.buffer<uint32_t>("index.voxels", p.count("voxels"));
  lists.first = p.buffer<uint32_t>("triangles.first", p.count("voxels") + 1);
  const size_t entries = p.count("triangle_entries");
  if (entries == 0) return lists;
  lists.ids = gpu::downloadAs<uint32_t>(oracles::sharedDevice(), *p.executor->findGrown("triangles.ids").at(0), entries);
  lists.pieces = gpu::downloadAs<glm::uvec2>(oracles::sharedDevice(), *p.executor->findGrown("triangles.pieces").at(0), entries);
  return lists;
}

scene::Scene randomScene(uint32_t seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.f, 10.f), size(-2.f, 2.f);
  oracle::Soup soup;
  for (int i = 0; i < count; ++i) {
    oracle::SoupTriangle t;
    t.position[0] = glm::vec3(place(random), place(random), place(random));
    for (int c = 1; c < 3; ++c) t.position[c] = t.position[0] + glm::vec3(size(random), size(random), size(random));
    soup.push_back(t);
  }
  return oracle::sceneOf(soup);
}

TEST_F(TrianglesTest, EveryVoxelListsTheTrianglesThatOverlapIt) {
  const scene::Scene scene = randomScene(3, 60);
  const Lists lists = listsOf(scene, 14);
  size_t overlaps = 0, sure = 0;
  ASSERT_EQ(lists.first.back(), lists.ids.size());
  for (size_t v = 0; v < lists.voxels.size(); ++v) {
    const glm::dvec3 centre = glm::dvec3(shared::unpackVoxel(lists.voxels[v])) + 0.5;
    std::vector<uint32_t> list(lists.ids.begin() + lists.first[v], lists.ids.begin() + lists.first[v + 1]);
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
    EXPECT_EQ(std::adjacent_find(list.begin(), list.end()), list.end()) << "a triangle twice";
    for (uint32_t t = 0; t < scene.triangleCount(); ++t) {
      oracle::Corners corners;
      for (int c = 0; c < 3; ++c)
        corners[c] = (glm::dvec3(scene.vertices[scene.indices[3 * t + c]].position) - glm::dvec3(lists.grid.origin)) / double(lists.grid.h);
      const bool listed = std::binary_search(list.begin(), list.end(), t);
      const bool must = oracle::overlapsCube(corners, centre, 0.5), may = oracle::overlapsCube(corners, centre, 0.5 + kDilationBound);
      overlaps += listed;
      sure += must;
      EXPECT_TRUE(!must || listed) << "voxel " << v << " lacks triangle " << t;
      EXPECT_TRUE(may || !listed) << "voxel " << v << " lists triangle " << t << " that does not reach it";
    }
  }
  EXPECT_GT(sure, 500u);
  EXPECT_EQ(overlaps, lists.ids.size());
}

TEST_F(TrianglesTest, PiecesLieInTheirVoxelsAndAddUpToTheMesh) {
  const scene::Scene scene = randomScene(5, 40);
  const Lists lists = listsOf(scene, 11);
  std::vector<double> area(scene.triangleCount());
  for (size_t v = 0; v < lists.voxels.size(); ++v) {
    for (uint32_t e = lists.first[v]; e < lists.first[v + 1]; ++e) {
      const uint32_t t = lists.ids[e];
      const float piece = std::bit_cast<float>(lists.pieces[e].y);
      ASSERT_GE(piece, 0.f);
      area[t] += piece;
      if (piece < 1e-4f) continue;
      // The middle lies in the triangle's plane.
      const glm::vec3 middle = glm::vec3(shared::unpackVoxel(lists.voxels[v])) + shared::decodePosition(lists.pieces[e].x);
      glm::vec3 p[3];
      for (int c = 0; c < 3; ++c) p[c] = shared::toGridSpace(lists.grid, scene.vertices[scene.indices[3 * t + c]].position);
      EXPECT_NEAR(glm::dot(glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])), middle - p[0]), 0.f, 2e-3f);
    }
  }
  for (uint32_t t = 0; t < scene.triangleCount(); ++t) {
    glm::dvec3 p[3];
    for (int c = 0; c < 3; ++c) p[c] = glm::dvec3(scene.vertices[scene.indices[3 * t + c]].position) / double(lists.grid.h);
    const double whole = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    EXPECT_NEAR(area[t], whole, 1e-4 * whole + 1e-5) << t;
  }
}

TEST_F(TrianglesTest, CrowdedVoxelsHaveNoList) {
  const scene::Scene scene = randomScene(3, 60);
  const Lists all = listsOf(scene, 14), few = listsOf(scene, 14, "1");
  size_t crowded = 0;
  for (size_t v = 0; v < all.voxels.size(); ++v) {
    const uint32_t count = all.first[v + 1] - all.first[v];
    EXPECT_EQ(few.first[v + 1] - few.first[v], count > 1 ? 0 : count);
    crowded += count > 1;
  }
  EXPECT_GT(crowded, 10u);
}

/// Where triangles.corners is not read (too many triangles, or a graph without the edge) rays load vertices.
TEST_F(TrianglesTest, SlowCornersAndVerticesGiveTheSameBits) {
  const auto render = [](bool corners) {
    PipelineOptions options;
    options.graph = "clustered_voxel_pixels";
    options.settings = {{"voxelize.resolution", "16"}, {"visibility.rays", "4"}, {"gather_pixels.rays", "2"}};
    options.outputs = {"visibility.weights", "gather_pixels.irradiance"};
    if (!corners) options.disconnected = {"visibility.corners", "gather_pixels.corners"};
    Pipeline p(oracles::sharedDevice(), scene::loadScene("builtin:cornell_point"), options);
    p.run();
    EXPECT_EQ(p.executor->findImage("triangles.corners") != nullptr, corners);
    return std::pair(p.buffer<uint32_t>("visibility.weights"), p.picture("gather_pixels.irradiance").data);
  };
  const auto [weights, picture] = render(true);
  const auto [otherWeights, otherPicture] = render(false);
  EXPECT_EQ(weights, otherWeights);
  EXPECT_EQ(picture, otherPicture);
  EXPECT_GT(*std::max_element(picture.begin(), picture.end()), 0.f);
}

}  // namespace
}  // namespace radivox
