// cluster and members against the CPU's clusters, face for face, and against what must hold for any clustering.
#include "modules/clustered_voxel/cluster/cluster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "engine/scene/builtin.h"
#include "modules/clustered_voxel/cluster/members.h"
#include "shaders/shared/cluster_member.h"
#include "tests/oracles/cluster_oracle.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox {
namespace {

using oracle::ClusterSettings;
using oracle::VoxelStructures;

VoxelStructures voxelsOf(const std::string& name, uint32_t resolution) {
  return oracle::buildVoxelStructures(oracle::soupOf(scene::makeBuiltin(name)), resolution);
}

/// Triangles of every size and direction through each other: normals that agree with nobody's, crumbs of surface.
VoxelStructures rubble(uint32_t triangleCount, uint32_t resolution, uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](float low, float high) { return low + (high - low) * static_cast<float>(random()) / 4294967296.f; };
  oracle::Soup soup;
  for (uint32_t i = 0; i < triangleCount; ++i) {
    oracle::SoupTriangle triangle;
    const glm::vec3 centre(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    const float size = std::exp2(uniform(-5, -1));
    for (glm::vec3& p : triangle.position) p = centre + size * glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    triangle.albedo = glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    soup.push_back(triangle);
  }
  return oracle::buildVoxelStructures(soup, resolution);
}

class ClusterTest : public oracles::GpuTest {
 protected:
  struct Output {
    std::vector<uint32_t> labels, members;
    std::vector<shared::Cluster> clusters;
    std::vector<shared::ClusterPlace> places;
    uint32_t clusterCount = 0;
    std::map<std::string, double> figures;
  };

  static void feed(oracles::NodeHarness& h, const VoxelStructures& s) {
    h.importValue("in.grid", s.grid);
    h.importBuffer("in.occupancy", s.occupancy);
    h.importBuffer("in.rank", s.rank);
    h.importBuffer("in.voxels", s.voxels);
    h.importBuffer("in.mask", s.mask);
    h.importBuffer("in.first", s.first);
    h.importBuffer("in.faces", s.faces);
    h.setCount("voxels", s.voxels.size());
    h.setCount("faces", s.faces.size());
  }

  Output cluster(const VoxelStructures& s, const ClusterSettings& settings) {
    oracles::NodeHarness h(device());
    feed(h, s);
    h.add<clustered_voxel::Cluster>("cluster");
    h.add<clustered_voxel::Members>("members");
    for (const char* port : {"grid", "occupancy", "rank", "voxels", "mask", "first", "faces"})
      h.connect(std::string("in.") + port, std::string("cluster.") + port);
    h.connect("in.voxels", "members.voxels");
    h.connect("in.faces", "members.faces");
    h.connect("cluster.labels", "members.labels");
    h.set("cluster.spacing", std::to_string(settings.spacing));
    h.set("cluster.angle", std::to_string(settings.angleDegrees));
    h.set("cluster.space_weight", std::to_string(settings.spaceWeight));
    h.set("cluster.normal_weight", std::to_string(settings.normalWeight));
    h.set("cluster.iterations", std::to_string(settings.iterations));
    h.set("cluster.stop_fraction", std::to_string(settings.stopFraction));
    h.set("cluster.merge", std::to_string(settings.merge));
    for (const char* port : {"cluster.labels", "cluster.status", "members.members", "members.clusters", "members.places"}) h.output(port);
    h.run();
    Output out;
    out.clusterCount = static_cast<uint32_t>(h.count("clusters"));
    out.labels = h.download<uint32_t>("cluster.labels", s.faces.size());
    out.members = h.download<uint32_t>("members.members", s.faces.size());
    out.clusters = h.download<shared::Cluster>("members.clusters", out.clusterCount + 1);
    out.places = h.download<shared::ClusterPlace>("members.places", out.clusterCount);
    for (const char* name : {"seeds", "iterations", "orphans", "pieces", "merged", "clusters"})
      out.figures[name] = h.figure("cluster", name);
    return out;
  }

  /// Node against oracle, and both against the definition.
  Output check(const VoxelStructures& s, const ClusterSettings& settings) {
    const Output out = cluster(s, settings);
    const oracle::ClusterResult expected = oracle::clusterFaces(s, settings);
    EXPECT_EQ(oracle::checkClusters(s, out.labels, out.clusterCount, settings.angleDegrees), "");
    EXPECT_EQ(out.clusterCount, expected.clusterCount);
    EXPECT_EQ(out.figures.at("seeds"), expected.seedCount);
    EXPECT_EQ(out.figures.at("iterations"), expected.iterations);
    EXPECT_EQ(out.figures.at("orphans"), expected.orphanCount);
    EXPECT_EQ(out.figures.at("pieces"), expected.pieceCount);
    EXPECT_EQ(out.figures.at("merged"), expected.mergedCount);
    size_t different = 0;
    for (size_t i = 0; i < out.labels.size(); ++i) different += out.labels[i] != expected.labels[i] ? 1 : 0;
    EXPECT_EQ(different, 0u) << "of " << out.labels.size() << " faces";
    std::printf("[ figures  ] %zu faces, %.0f seeds, %.0f rounds, %.0f orphans, %.0f pieces, %.0f merged, %u clusters\n", s.faces.size(),
                out.figures.at("seeds"), out.figures.at("iterations"), out.figures.at("orphans"), out.figures.at("pieces"),
                out.figures.at("merged"), out.clusterCount);
    return out;
  }
};

TEST_F(ClusterTest, SlowSphereEqualsOracle) { check(voxelsOf("sphere", 40), {}); }
TEST_F(ClusterTest, StaircaseEqualsOracle) { check(voxelsOf("staircase", 40), {}); }
TEST_F(ClusterTest, CornellEqualsOracle) { check(voxelsOf("cornell", 48), {}); }

TEST_F(ClusterTest, SlowRubbleEqualsOracle) {
  const Output out = check(rubble(300, 32, 1), {});
  EXPECT_GT(out.figures.at("orphans"), 0);  // or founding clusters went untested
  EXPECT_GT(out.figures.at("merged"), 0);
}

TEST_F(ClusterTest, SlowEveryParameterEqualsOracle) {
  const VoxelStructures s = rubble(60, 24, 2);
  check(s, {.spacing = 7, .angleDegrees = 20.f});
  check(s, {.spacing = 2, .angleDegrees = 44.f, .merge = 0});
  check(s, {.spaceWeight = 0.f});  // the paper's distance
  check(s, {.normalWeight = 0.f, .iterations = 3, .merge = 1});
  check(s, {.spacing = 32, .angleDegrees = 5.f, .stopFraction = 0.2f});  // sums in coarser units
}

TEST_F(ClusterTest, FlatWallIsTiledByClustersOfOneCell) {
  oracle::Soup soup;
  oracle::addQuad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const VoxelStructures s = oracle::buildVoxelStructures(soup, 64);
  const Output out = check(s, {});
  EXPECT_EQ(out.figures.at("orphans"), 0);
  // 16 × 16 cells, two sides.
  EXPECT_EQ(out.clusterCount, 512u);
  for (uint32_t c = 0; c < out.clusterCount; ++c) EXPECT_LE(out.clusters[c + 1].firstMember - out.clusters[c].firstMember, 32u);
}

TEST_F(ClusterTest, SidesOfAThinWallNeverMeet) {
  const VoxelStructures s = voxelsOf("thin_wall", 32);
  const Output out = check(s, {});
  std::vector<glm::vec3> direction(out.clusterCount, glm::vec3(0.f));
  for (size_t i = 0; i < s.faces.size(); ++i) {
    const glm::vec3 n = shared::decodeNormal(s.faces[i].normal);
    glm::vec3& d = direction[out.labels[i]];
    if (d == glm::vec3(0.f)) d = n;
    EXPECT_GT(glm::dot(d, n), 0.f) << "face " << i;
  }
}

TEST_F(ClusterTest, TwoRunsGiveTheSameBits) {
  const VoxelStructures s = rubble(200, 32, 3);
  const Output a = cluster(s, {}), b = cluster(s, {});
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.members, b.members);
  ASSERT_EQ(a.clusters.size(), b.clusters.size());
  EXPECT_EQ(std::memcmp(a.clusters.data(), b.clusters.data(), a.clusters.size() * sizeof(shared::Cluster)), 0);
  EXPECT_EQ(std::memcmp(a.places.data(), b.places.data(), a.places.size() * sizeof(shared::ClusterPlace)), 0);
}

TEST_F(ClusterTest, NothingGivesNoClusters) {
  VoxelStructures s;
  s.grid.size = glm::uvec3(1);
  s.grid.bricks = glm::uvec3(1);
  s.grid.brickCount = 1;
  s.occupancy = {glm::uvec2(0)};
  s.rank = {0};
  s.first = {0};
  const Output out = cluster(s, {});
  EXPECT_EQ(out.clusterCount, 0u);
}

TEST_F(ClusterTest, TouchedVoxelsWithoutFacesJoinNothing) {
  // Three sheets; the middle one lies in the plane between two voxels, belongs to the upper and only touches the lower.
  oracle::Soup soup;
  const float h = 1.f / 16;
  for (float y : {0.f, 1.5f * h, 3.f * h}) oracle::addQuad(soup, {0, y, 0}, {1, 0, 0}, {0, 0, 1});
  const VoxelStructures s = oracle::buildVoxelStructures(soup, 17);
  EXPECT_GT(std::count(s.mask.begin(), s.mask.end(), 0u), 0);
  check(s, {});
}

TEST_F(ClusterTest, SlowMembersAreListedAndDescribed) {
  const VoxelStructures s = rubble(200, 32, 4);
  // Clusters of very different sizes: the paper's distance lets some grow far.
  const Output out = cluster(s, {.spacing = 12, .spaceWeight = 0.f});
  EXPECT_EQ(out.members, oracle::listMembers(out.labels, out.clusterCount));
  const auto expected = oracle::describeClusters(s, out.labels, out.clusterCount);
  double area = 0, faceArea = 0;
  for (uint32_t c = 0; c < out.clusterCount; ++c) {
    const shared::Cluster &a = out.clusters[c], &e = expected.clusters[c];
    const shared::ClusterPlace &place = out.places[c], &there = expected.places[c];
    EXPECT_EQ(a.firstMember, e.firstMember);
    EXPECT_LT(glm::distance(a.albedo, e.albedo), 1e-6f);
    EXPECT_NEAR(place.area, there.area, 1e-6 * there.area);
    EXPECT_LT(glm::distance(place.position, there.position), 1e-5f);
    EXPECT_LT(glm::distance(place.normal, there.normal), 1e-5f);
    area += static_cast<double>(place.area);
  }
  EXPECT_EQ(out.clusters.at(out.clusterCount).firstMember, s.faces.size());
  for (const shared::Face& face : s.faces) faceArea += static_cast<double>(face.area);
  EXPECT_NEAR(area, faceArea, 1e-6 * faceArea);
}

// For weights of any size a share is its weight over the largest, to the nearest of 255 steps.
TEST(ClusterMembers, SharesAreRoundedToTheNearestStep) {
  std::mt19937 random(5);
  for (int i = 0; i < 100000; ++i) {
    const auto draw = [&] { return static_cast<uint32_t>(random()); };
    const uint32_t greatest = std::max(draw() >> (draw() % 32), 1u), weight = i % 7 == 0 ? greatest : draw() % greatest;
    const uint32_t member = shared::memberWith(0xabcdefu, weight, greatest);
    EXPECT_EQ(shared::memberFace(member), 0xabcdefu);
    EXPECT_NEAR(shared::memberShare(member), 255.0 * weight / greatest, 0.5 + 0.02) << weight << " of " << greatest;
  }
  EXPECT_EQ(shared::memberShare(shared::memberWith(1, 0xffffffffu, 0xffffffffu)), 255u);
}

}  // namespace
}  // namespace radivox
