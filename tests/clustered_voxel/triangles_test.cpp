// clustered_voxel.triangles against the separating-axis test in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>

#include "shaders/shared/listed_triangle.h"
#include "shaders/shared/triangle_corners.h"
#include "shaders/shared/visibility_row.h"
#include "shaders/shared/voxel_codec.h"
#include "tests/clustered_voxel/visibility_run.h"
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
  std::vector<uint32_t> apart;  // listedApart of each entry
  std::vector<glm::uvec2> pieces;
};

Lists listsOf(Pipeline& p) {
  Lists lists;
  lists.grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
  lists.voxels = p.buffer<uint32_t>("index.voxels", p.count("voxels"));
  lists.first = p.buffer<uint32_t>("triangles.first", p.count("voxels") + 1);
  const size_t entries = p.count("triangle_entries");
  if (entries == 0) return lists;
  const auto words = gpu::downloadAs<uint32_t>(oracles::sharedDevice(), *p.executor->findGrown("triangles.ids").at(0), entries);
  for (const uint32_t word : words) {
    lists.ids.push_back(shared::listedTriangle(word));
    lists.apart.push_back(shared::listedApart(word));
  }
  const auto pieces = p.executor->findGrown("triangles.pieces");
  if (!pieces.empty()) lists.pieces = gpu::downloadAs<glm::uvec2>(oracles::sharedDevice(), *pieces.at(0), entries);
  return lists;
}

Lists listsOf(const scene::Scene& scene, uint32_t resolution, const std::string& most = "256") {
  PipelineOptions options;
  options.graph = "clustered_voxel_pixels";
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}, {"triangles.most", most}};
  options.outputs = {"voxelize.grid", "index.voxels", "triangles.first", "triangles.ids", "triangles.pieces"};
  Pipeline p(oracles::sharedDevice(), scene, options);
  p.run();
  return listsOf(p);
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

// Sides of walls -----------------------------------------------------------------------------------------------------------------------

/// A room whose walls are two skins `wall` voxels apart, turned so that nothing is in line with the grid; `edgeOn`: so that two of them look along x
/// the most, on either side of the edge between them.
scene::Scene roomOfSkins(float wall, uint32_t resolution, bool doubleSided, bool edgeOn = false) {
  const float thick = wall * 7.f / static_cast<float>(resolution - 1);
  oracle::Soup soup;
  oracle::addBox(soup, glm::vec3(-2.f), glm::vec3(2.f), glm::vec3(0.5f), true);
  oracle::addBox(soup, glm::vec3(-2.f - thick), glm::vec3(2.f + thick), glm::vec3(0.5f), false);
  const glm::quat turn =
      edgeOn ? glm::angleAxis(0.77f, glm::normalize(glm::vec3(0.f, -1.f, 1.f))) * glm::angleAxis(0.77f, glm::vec3(1.f, 0.f, 0.f))
             : glm::angleAxis(0.4f, glm::normalize(glm::vec3(0.3f, 1.f, 0.2f)));
  for (oracle::SoupTriangle& t : soup) {
    t.doubleSided = doubleSided;
    for (int c = 0; c < 3; ++c) {
      t.position[c] = turn * t.position[c];
      t.normal[c] = turn * t.normal[c];
    }
  }
  scene::Scene scene = oracle::sceneOf(soup);
  scene::PunctualLight sun;
  sun.direction = glm::normalize(glm::vec3(0.5f, -1.f, 0.3f));
  sun.intensity = glm::vec3(10.f);
  scene.lights = {sun};
  return scene;
}

Pipeline runOf(const scene::Scene& scene, uint32_t resolution, const char* faces) {
  PipelineOptions options;
  options.graph = "clustered_voxel_pixels";
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}, {"voxelize.faces", faces}};
  options.outputs = {"voxelize.grid",    "index.voxels", "triangles.first", "triangles.ids",
                     "triangles.pieces", "faces.mask",   "faces.first",     "surface.faces"};
  Pipeline p(oracles::sharedDevice(), scene, options);
  p.run();
  return p;
}

/// One side of a piece of surface in a voxel, in double precision.
struct PieceSide {
  size_t entry = 0;
  std::vector<glm::dvec3> corners;
  glm::dvec3 normal{0}, middle{0};
  double area = 0;

  double weightOn(int k, bool dominant) const { return area * oracle::faceShare(normal, k, dominant); }
  int faceOn(int k) const { return 2 * k + (normal[k] < 0 ? 1 : 0); }
  /// How far the piece reaches in front of another's plane, voxels.
  double reachAhead(const PieceSide& other) const {
    double reach = -1e30;
    for (const glm::dvec3& p : corners) reach = std::max(reach, glm::dot(p - other.middle, other.normal));
    return reach;
  }
};

enum class Answer { No, Yes, Unsure };  // Unsure: within the rounding of 10-bit middles

Answer isApart(const PieceSide& leader, const PieceSide& piece) {
  const double cosine = glm::dot(leader.normal, piece.normal);
  if (cosine > 0.502) return Answer::No;
  const double a = piece.reachAhead(leader), b = leader.reachAhead(piece);
  if (cosine > 0.498 || std::abs(a - 0.01) < 4e-3 || std::abs(b - 0.01) < 4e-3) return Answer::Unsure;
  return (a > 0.01) != (b > 0.01) ? Answer::Yes : Answer::No;
}

/// Does `other` stand before `side`, looking the same way, where a line from its middle along its normal meets it in the voxel?
Answer covers(const PieceSide& other, const PieceSide& side, const oracle::Corners& corners, const glm::dvec3& low) {
  constexpr double kNear = 4e-3;
  const auto answer = [](double value, double least, double slack) {
    return value < least - slack ? Answer::No : value > least + slack ? Answer::Yes : Answer::Unsure;
  };
  const double slope = glm::dot(other.normal, side.normal);
  std::vector<Answer> all = {answer(slope, 0.5, 2e-3), answer(glm::dot(other.middle - side.middle, side.normal), 0.01, kNear)};
  if (all[0] == Answer::No) return Answer::No;
  const double t = glm::dot(corners[0] - side.middle, other.normal) / slope;
  all.push_back(answer(t, 0.01, kNear));
  const glm::dvec3 hit = side.middle + t * side.normal;
  for (int k = 0; k < 3; ++k) {
    all.push_back(answer(hit[k] - low[k], 0, kNear));
    all.push_back(answer(low[k] + 1 - hit[k], 0, kNear));
  }
  const glm::dvec3 front = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 edge = glm::normalize(corners[(c + 1) % 3] - corners[c]);
    all.push_back(answer(glm::dot(glm::cross(edge, hit - corners[c]), front), 0, kNear));
  }
  if (std::find(all.begin(), all.end(), Answer::No) != all.end()) return Answer::No;
  return std::find(all.begin(), all.end(), Answer::Unsure) != all.end() ? Answer::Unsure : Answer::Yes;
}

oracle::Corners cornersInGrid(const scene::Scene& scene, const Lists& lists, uint32_t triangle) {
  oracle::Corners corners;
  for (int c = 0; c < 3; ++c)
    corners[c] =
        (glm::dvec3(scene.vertices[scene.indices[3 * triangle + c]].position) - glm::dvec3(lists.grid.origin)) / double(lists.grid.h);
  return corners;
}

std::vector<PieceSide> sidesIn(const scene::Scene& scene, const Lists& lists, size_t v) {
  std::vector<PieceSide> sides;
  const glm::dvec3 low(shared::unpackVoxel(lists.voxels[v]));
  for (uint32_t e = lists.first[v]; e < lists.first[v + 1]; ++e) {
    const uint32_t t = lists.ids[e];
    const oracle::Corners corners = cornersInGrid(scene, lists, t);
    PieceSide side;
    side.entry = e;
    side.corners = oracle::clipToVoxel(corners, low);
    side.normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    side.area = side.corners.empty() ? 0 : oracle::areaOf(side.corners);
    side.middle = side.corners.empty() ? low : oracle::centroidOf(side.corners);
    sides.push_back(side);
    if ((scene.materials[scene.triangleMaterials[t]].flags & shared::kMaterialDoubleSided) == 0u) continue;
    side.normal = -side.normal;
    sides.push_back(side);
  }
  return sides;
}

TEST_F(TrianglesTest, PiecesAcrossAWallAreNoPartOfAFace) {
  size_t apartCount[2] = {}, checked = 0, unsure = 0, covered = 0;
  const auto scenesOf = [](bool dominant) {
    return std::vector{roomOfSkins(0.3f, 20, false, dominant), roomOfSkins(0.5f, 20, true, dominant), randomScene(7, 60)};
  };
  for (const bool dominant : {false, true}) {
    for (const scene::Scene& scene : scenesOf(dominant)) {
      Pipeline p = runOf(scene, 20, dominant ? "dominant" : "projected");
      const Lists lists = listsOf(p);
      for (size_t v = 0; v < lists.voxels.size(); ++v) {
        const std::vector<PieceSide> sides = sidesIn(scene, lists, v);
        double most[6] = {}, second[6] = {};
        const PieceSide* leader[6] = {};
        for (const PieceSide& side : sides) {
          for (int k = 0; k < 3; ++k) {
            const int f = side.faceOn(k);
            const double weight = side.weightOn(k, dominant);
            if (weight > most[f]) {
              second[f] = most[f];
              most[f] = weight;
              leader[f] = &side;
            } else {
              second[f] = std::max(second[f], weight);
            }
          }
        }
        std::vector<uint32_t> expected(lists.first[v + 1] - lists.first[v]);
        std::vector<bool> isUnsure(expected.size());
        // Surfaces all within 30 degrees of the first are one that bends: no wall stands between them. Where they lie on one plane, none covers another.
        bool bends = true, layered = false, isLayeredUnsure = false;
        for (const PieceSide& side : sides) {
          const double cosine = std::abs(glm::dot(side.normal, sides[0].normal));
          bends = bends && cosine > 0.87;
          if (std::abs(cosine - 0.87) < 1e-4) isUnsure.assign(isUnsure.size(), true);
          const double step = std::abs(glm::dot(side.middle - sides[0].middle, sides[0].normal));
          layered = layered || step > 0.014;
          isLayeredUnsure = isLayeredUnsure || step > 0.006;
        }
        for (const PieceSide& side : sides) {
          const size_t i = side.entry - lists.first[v];
          uint32_t covering = 0, perhaps = 0;
          for (const PieceSide& other : sides) {
            if (other.entry == side.entry) continue;
            const Answer answer =
                covers(other, side, cornersInGrid(scene, lists, lists.ids[other.entry]), glm::dvec3(shared::unpackVoxel(lists.voxels[v])));
            for (int k = 0; k < 3; ++k) {
              if (oracle::faceShare(other.normal, k, dominant) == 0) continue;
              covering |= answer == Answer::Yes ? 1u << other.faceOn(k) : 0u;
              perhaps |= answer == Answer::Unsure ? 1u << other.faceOn(k) : 0u;
            }
          }
          if (!layered) {
            perhaps |= isLayeredUnsure ? covering : 0u;
            covering = 0;
          }
          uint32_t leaves = 0;
          bool stays = dominant;  // of the one face that it would be part of a piece may leave
          for (int k = 0; k < 3; ++k) {
            const int f = side.faceOn(k);
            if (oracle::faceShare(side.normal, k, dominant) == 0) continue;
            bool leavesIt = (covering >> f & 1u) != 0;
            if (!leavesIt && (perhaps >> f & 1u) != 0) isUnsure[i] = true;
            if (leader[f] != nullptr && !bends) {
              // A tie of two leaders may fall either way.
              if (!leavesIt && (most[f] < 1e-3 || second[f] > 0.999 * most[f])) isUnsure[i] = true;
              const Answer answer = leader[f]->entry == side.entry ? Answer::No : isApart(*leader[f], side);
              if (!leavesIt && answer == Answer::Unsure) isUnsure[i] = true;
              leavesIt = leavesIt || answer == Answer::Yes;
            }
            if (side.area < 1e-4) isUnsure[i] = true;
            covered += (covering >> f & 1u) != 0;
            leaves |= leavesIt ? 1u << f : 0u;
            stays = stays || !leavesIt;
          }
          if (stays) expected[i] |= leaves;
        }
        if (expected.size() > 64) expected.assign(expected.size(), 0);
        for (size_t i = 0; i < expected.size(); ++i) {
          const size_t e = lists.first[v] + i;
          const uint32_t flags = scene.materials[scene.triangleMaterials[lists.ids[e]]].flags;
          if ((flags & shared::kMaterialDoubleSided) == 0u) expected[i] |= (expected[i] & 21u) << 1 | ((expected[i] >> 1) & 21u);
          unsure += isUnsure[i];
          if (isUnsure[i]) continue;
          ++checked;
          apartCount[dominant ? 1 : 0] += expected[i] != 0;
          EXPECT_EQ(lists.apart[e], expected[i]) << "voxel " << v << ", triangle " << lists.ids[e];
        }
      }
    }
  }
  EXPECT_GT(apartCount[0], 200u);
  EXPECT_GT(apartCount[1], 50u);
  EXPECT_GT(checked, 4 * unsure);
  EXPECT_GT(covered, 500u);
  std::printf("%zu pieces checked, %zu and %zu of them apart, %zu covered; %zu too close to tell\n", checked, apartCount[0], apartCount[1],
              covered, unsure);
}

// What surface makes of them: area of a face is that of the pieces that are part of it.
TEST_F(TrianglesTest, FacesAreMadeOfThePiecesThatArePartOfThem) {
  for (const bool dominant : {false, true}) {
    const scene::Scene scene = roomOfSkins(0.3f, 20, false, dominant);
    Pipeline p = runOf(scene, 20, dominant ? "dominant" : "projected");
    const Lists lists = listsOf(p);
    const auto mask = p.buffer<uint32_t>("faces.mask", p.count("voxels")), first = p.buffer<uint32_t>("faces.first", p.count("voxels"));
    const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
    size_t checked = 0, left = 0;
    for (size_t v = 0; v < lists.voxels.size(); ++v) {
      double area[6] = {}, whole[6] = {};
      for (const PieceSide& side : sidesIn(scene, lists, v)) {
        for (int k = 0; k < 3; ++k) {
          const int f = side.faceOn(k);
          const double weight = side.weightOn(k, dominant);
          whole[f] += weight;
          if ((lists.apart[side.entry] >> f & 1u) == 0u) area[f] += weight;
        }
      }
      for (int f = 0; f < 6; ++f) {
        if ((mask[v] >> f & 1u) == 0u) continue;
        const shared::Face& face = faces[first[v] + std::popcount(mask[v] & ((1u << f) - 1))];
        if (whole[f] > 0 && whole[f] < 1e-5) continue;  // scraps
        const int of = whole[f] > 0 ? f : f ^ 1;        // fronts, or backs where it has none
        EXPECT_NEAR(face.area, area[of], 1e-4 + 1e-4 * area[of]) << "voxel " << v << ", face " << f;
        ++checked;
        left += area[of] < 0.99 * whole[of];
      }
    }
    EXPECT_GT(left, dominant ? 20u : 100u);
    std::printf("%zu faces, %zu of them without some of their surface\n", checked, left);
  }
}

// What inject makes of them: no sun on voxel faces that are made of the inside alone.
TEST_F(TrianglesTest, NoLightFallsOnFacesOfTheOtherSide) {
  for (const bool dominant : {false, true}) {
    PipelineOptions options;
    const scene::Scene scene = roomOfSkins(0.3f, 20, false, dominant);
    options.graph = "clustered_voxel_pixels";
    options.settings = {{"voxelize.resolution", "20"}, {"visibility.rays", "4"}, {"voxelize.faces", dominant ? "dominant" : "projected"}};
    options.outputs = {"voxelize.grid", "index.voxels", "triangles.first", "triangles.ids",
                       "faces.mask",    "faces.first",  "surface.faces",   "inject.face_irradiance"};
    Pipeline p(oracles::sharedDevice(), scene, options);
    p.run();
    const auto mask = p.buffer<uint32_t>("faces.mask", p.count("voxels")), first = p.buffer<uint32_t>("faces.first", p.count("voxels"));
    const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance", p.count("faces"));
    const Lists lists = listsOf(p);
    size_t inner = 0, mixed = 0, lit = 0;
    constexpr uint32_t kInner = 12;  // the first box's triangles
    for (size_t v = 0; v < lists.voxels.size(); ++v) {
      for (int f = 0; f < 6; ++f) {
        if ((mask[v] >> f & 1u) == 0u) continue;
        bool hasInner = false, hasOuter = false, leftOuter = false;
        for (const PieceSide& side : sidesIn(scene, lists, v)) {
          if (side.faceOn(f >> 1) != f || side.weightOn(f >> 1, dominant) <= 0) continue;
          const bool isInner = lists.ids[side.entry] < kInner, isApart = (lists.apart[side.entry] >> f & 1u) != 0u;
          hasInner = hasInner || (isInner && !isApart);
          hasOuter = hasOuter || (!isInner && !isApart);
          leftOuter = leftOuter || (!isInner && isApart);
        }
        const glm::vec3 light = irradiance[first[v] + std::popcount(mask[v] & ((1u << f) - 1))];
        lit += light.x > 0;
        if (!hasInner || hasOuter) continue;
        ++inner;
        mixed += leftOuter;
        EXPECT_EQ(light.x, 0.f) << "voxel " << v << ", face " << f << (leftOuter ? ", which a piece of the outside has left" : "");
      }
    }
    EXPECT_GT(mixed, dominant ? 10u : 50u);
    EXPECT_GT(lit, 100u);
    std::printf("%zu faces of the inside, %zu of them left by pieces of the outside; %zu faces lit\n", inner, mixed, lit);
  }
}

// Mean planes reach beyond the edges of what they stand for. In a room of closed bodies nobody sees a back; where planes alone stop rays, some do.
TEST_F(TrianglesTest, WhatIsMetFromBehindIsABackOnlyIfItsTrianglesSaySo) {
  oracle::Soup soup;
  oracle::addBox(soup, glm::vec3(0.f), glm::vec3(4.f), glm::vec3(0.5f), true);
  oracle::addSphere(soup, glm::vec3(1.2f), 0.7f, 6);
  oracle::addSphere(soup, glm::vec3(2.9f, 1.1f, 2.6f), 0.5f, 5);
  for (oracle::SoupTriangle& t : soup) t.doubleSided = false;
  scene::Scene scene = oracle::sceneOf(soup);
  scene::PunctualLight lamp;
  lamp.type = shared::kLightPoint;
  lamp.position = glm::vec3(2.f, 3.f, 2.f);
  lamp.intensity = glm::vec3(10.f);
  scene.lights = {lamp};
  for (const char* faces : {"projected", "dominant"}) {
    double share[2] = {};  // of the rays of fronts, those that end on backs
    for (const bool hasTriangles : {false, true}) {
      PipelineOptions options;
      options.graph = "clustered_voxel_pixels";
      options.settings = {{"voxelize.resolution", "40"},
                          {"voxelize.faces", faces},
                          {"visibility.near", "4096"},
                          {"visibility.triangles", hasTriangles ? "2" : "0"}};
      options.outputs = {"visibility.row_start", "visibility.entries", "surface.faces"};
      Pipeline p(oracles::sharedDevice(), scene, options);
      p.run();
      const auto all = p.buffer<shared::Face>("surface.faces", p.count("faces"));
      const auto starts = p.buffer<uint32_t>("visibility.row_start");
      const auto clusterCount = static_cast<uint32_t>(p.count("clusters")), idCount = clusterCount + static_cast<uint32_t>(all.size());
      const auto isBack = [&](uint32_t face) { return (all[face].position & shared::kMadeOfBacks) != 0; };
      std::vector<std::vector<uint32_t>> chunks;
      for (const gpu::Buffer* chunk : p.executor->findGrown("visibility.entries"))
        chunks.push_back(gpu::downloadAs<uint32_t>(oracles::sharedDevice(), *chunk, chunk->bytes() / 4));
      double rays = 0, backs = 0;
      for (uint32_t s = 0; s < all.size(); ++s) {
        if (isBack(s)) continue;
        const uint32_t chunk = s / shared::kRowsPerChunk, slot = s + chunk;
        shared::forEachRowEntry(chunks.at(chunk).data(), starts[slot], starts[slot + 1], idCount, [&](uint32_t id, uint32_t n) {
          rays += n;
          backs += id >= clusterCount && id < idCount && isBack(id - clusterCount) ? n : 0;
        });
      }
      share[hasTriangles ? 1 : 0] = backs / rays;
    }
    std::printf("%s: %.2e of the rays end on backs, %.2e where planes alone stop them\n", faces, share[1], share[0]);
    EXPECT_GT(share[0], 1e-3) << "the scene tests nothing";
    EXPECT_LT(share[1], 2e-4);
  }
}

/// Steps from what a voxel is cut into: no corner moves by more than half of one, whole voxels not at all, and one place has one code.
TEST(TriangleCorners, AreRoundedToTheirSteps) {
  std::mt19937 random(3);
  for (const glm::uvec3 size : {glm::uvec3(1), glm::uvec3(2, 1, 1), glm::uvec3(40, 128, 7), glm::uvec3(129, 3, 80), glm::uvec3(1023)}) {
    const float steps = shared::cornerSteps(size), step = shared::cornerStep(size);
    const float longest = static_cast<float>(std::max({size.x, size.y, size.z}));
    EXPECT_EQ(steps * step, 1.f);
    EXPECT_LE(longest, 2097152.f * step);
    EXPECT_TRUE(longest > 1048576.f * step || longest == 1.f) << "a finer step would do";
    for (int i = 0; i < 1000; ++i) {
      glm::vec3 p;
      for (glm::length_t k = 0; k < 3; ++k)
        p[k] = std::uniform_real_distribution<float>(0.f, static_cast<float>(size[k]) - 2.f * step)(random);
      if (i % 3 == 0) p = glm::floor(p);
      const glm::vec3 back = shared::decodeCorner(shared::encodeCorner(p, steps), step);
      for (glm::length_t k = 0; k < 3; ++k) EXPECT_LE(std::abs(back[k] - p[k]), i % 3 == 0 ? 0.f : 0.5f * step) << size.x << " " << p[k];
    }
    const glm::vec3 outside = shared::decodeCorner(shared::encodeCorner(glm::vec3(-1.f, 2e9f, 0.f), steps), step);
    EXPECT_EQ(outside, glm::vec3(0.f, 2097151.f * step, 0.f));
  }
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
    EXPECT_EQ(p.executor->findBuffer("triangles.corners") != nullptr, corners);
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
