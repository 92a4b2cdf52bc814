// How good the factors of clustered_voxel.visibility are: closed forms, and exact rays over the triangles. What is allowed here is
// about twice what was measured.
#include <gtest/gtest.h>

#include <cmath>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "tests/clustered_voxel/visibility_run.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox {
namespace {

using glm::vec3;
using oracle::addBox;
using oracle::addQuad;
using oracle::buildVoxelStructures;
using oracle::Row;
using oracle::Soup;
using oracle::VoxelStructures;

class VisibilityQualityTest : public oracles::GpuTest {
 protected:
  /// Rows with every face its own id (near = everything).
  std::vector<Row> rowsOf(const VoxelStructures& s, uint32_t rays = 128) {
    oracle::VisibilityRun run(device(), s, {.rays = rays, .near = 4096.f}, std::vector<uint32_t>(s.faces.size(), 0u));
    return run.rows();
  }
  /// Share of the rays of `row` that hit faces for which `test(face)` holds.
  template <class T>
  static double shareOf(const Row& row, const T& test) {
    double hits = 0, all = 0;
    for (const auto& [id, n] : row) {
      all += n;
      if (id < shared::kMissBase && test(id - 1)) hits += n;  // one cluster: face ids begin at 1
    }
    return hits / all;
  }
  static double missesOf(const Row& row) {
    double misses = 0, all = 0;
    for (const auto& [id, n] : row) {
      all += n;
      misses += id >= shared::kMissBase ? n : 0;
    }
    return misses / all;
  }
  /// Exact share of rays that leave the scene, from x_s about n_s.
  static double exactMisses(const Soup& soup, const VoxelStructures& s, uint32_t face, const std::vector<uint32_t>& directions) {
    const vec3 n = shared::decodeNormal(s.faces[face].normal);
    const glm::dvec3 origin = glm::dvec3(s.facePosition(face) + 0.02f * n) * double{s.grid.h} + glm::dvec3(s.grid.origin);
    double misses = 0;
    for (const uint32_t code : directions) {
      misses += oracle::castTriangles(soup, origin, glm::dvec3(shared::alongNormal(shared::decodeDirection(code), n))) < 0 ? 1 : 0;
    }
    return misses / static_cast<double>(directions.size());
  }
};

TEST_F(VisibilityQualityTest, UnitCubeFactors) {
  Soup soup;
  addBox(soup, vec3(0.f), vec3(1.f), vec3(0.5f), true);
  const VoxelStructures s = buildVoxelStructures(soup, 33);
  const std::vector<Row> rows = rowsOf(s, 256);
  const auto isInner = [&](uint32_t face) {
    const vec3 fromMiddle = s.facePosition(face) - 0.5f * vec3(s.grid.size);
    return glm::dot(fromMiddle, shared::decodeNormal(s.faces[face].normal)) < 0.f;
  };
  // From the wall that looks along +x to each of the others.
  double area = 0, factors[6] = {};
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    if (!isInner(face)) {
      EXPECT_EQ(missesOf(rows[face]), 1.0) << "an outer face sees the box";
      continue;
    }
    EXPECT_EQ(missesOf(rows[face]), 0.0) << "a ray left the closed box";
    if ((s.faces[face].key & 7u) != 0) continue;
    area += s.faces[face].area;
    for (uint32_t f = 0; f < 6; ++f) {
      factors[f] += s.faces[face].area * shareOf(rows[face], [&](uint32_t hit) { return (s.faces[hit].key & 7u) == f; });
    }
  }
  for (uint32_t f = 0; f < 6; ++f) RecordProperty("factor_" + std::to_string(f), std::to_string(factors[f] / area));
  EXPECT_NEAR(factors[0] / area, 0.0, 1e-3);     // itself
  EXPECT_NEAR(factors[1] / area, 0.1998, 4e-3);  // opposite
  for (uint32_t f = 2; f < 6; ++f) EXPECT_NEAR(factors[f] / area, 0.2000, 4e-3) << f;
}

TEST_F(VisibilityQualityTest, PatchUnderASquare) {
  // A unit square at unit distance, over its middle: 0.2395.
  Soup soup;
  addQuad(soup, {-0.5f, 1.f, -0.5f}, {1.f, 0.f, 0.f}, {0.f, 0.f, 1.f});
  addQuad(soup, {-0.01f, 0.f, -0.01f}, {0.f, 0.f, 0.02f}, {0.02f, 0.f, 0.f});
  const VoxelStructures s = buildVoxelStructures(soup, 48);
  const std::vector<Row> rows = rowsOf(s, 256);
  double area = 0, factor = 0;
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    if (s.facePosition(face).y > 2.f || (s.faces[face].key & 7u) != 2) continue;
    area += s.faces[face].area;
    factor += s.faces[face].area * (1.0 - missesOf(rows[face]));
  }
  ASSERT_GT(area, 0.0);
  RecordProperty("factor", std::to_string(factor / area));
  EXPECT_NEAR(factor / area, 0.2395, 0.008);
}

TEST_F(VisibilityQualityTest, PlanesDoNotShadowThemselves) {
  // A sheet sees nothing of itself, however it lies in the grid.
  for (const vec3& tilt : {vec3(0.f), vec3(0.f, 0.577f, 0.f), vec3(0.f, 0.31f, 0.17f), vec3(0.f, 1.f, 1.f)}) {
    Soup soup;
    addQuad(soup, vec3(0.f), vec3(0.f, tilt.z, 1.f), vec3(1.f, tilt.y, 0.f));
    const VoxelStructures s = buildVoxelStructures(soup, 32);
    double hits = 0;
    for (const Row& row : rowsOf(s)) hits += 1.0 - missesOf(row);
    RecordProperty("hits_" + std::to_string(static_cast<int>(100 * tilt.y)), std::to_string(hits / static_cast<double>(s.faces.size())));
    EXPECT_LT(hits / static_cast<double>(s.faces.size()), 2e-4) << tilt.y << " " << tilt.z;
  }
}

TEST_F(VisibilityQualityTest, SphereInABox) {
  Soup soup;
  const vec3 center(0.5f);
  oracle::addSphere(soup, center, 0.27f, 24);
  addBox(soup, vec3(0.f), vec3(1.f), vec3(0.5f), true);
  const VoxelStructures s = buildVoxelStructures(soup, 36);
  const std::vector<Row> rows = rowsOf(s);
  double outside = 0, outsideCount = 0, escapes = 0, self = 0, selfCount = 0, inner = 0, innerCount = 0;
  const float middle = 0.5f * static_cast<float>(s.grid.size.x);
  const auto radius = [&](uint32_t face) { return glm::length(s.facePosition(face) - middle) * s.grid.h; };
  const auto onSphere = [&](uint32_t face) { return radius(face) < 0.35f; };
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    const bool outward = glm::dot(s.facePosition(face) - middle, shared::decodeNormal(s.faces[face].normal)) > 0.f;
    if (!onSphere(face) && outward) {  // the box from outside
      outside += 1.0 - missesOf(rows[face]);
      ++outsideCount;
      continue;
    }
    escapes += missesOf(rows[face]);
    if (!onSphere(face)) continue;
    const double sphere = shareOf(rows[face], onSphere);
    (outward ? self : inner) += outward ? sphere : 1.0 - sphere;
    ++(outward ? selfCount : innerCount);
  }
  RecordProperty("self", std::to_string(self / selfCount));
  RecordProperty("inner", std::to_string(inner / innerCount));
  RecordProperty("outside", std::to_string(outside / outsideCount));
  EXPECT_LT(outside / outsideCount, 1e-3);
  EXPECT_EQ(escapes, 0.0);
  EXPECT_LT(self / selfCount, 2e-3) << "the sphere shadows itself";
  EXPECT_LT(inner / innerCount, 2e-3) << "rays from inside the sphere get out";
}

TEST_F(VisibilityQualityTest, ThinWallsPartRooms) {
  // Two rooms in a closed box, with a wall of no thickness between them: straight, and aslant.
  for (const float lean : {0.f, 0.2f}) {
    Soup soup;
    addBox(soup, vec3(0.f), {1.f, 0.5f, 0.5f}, vec3(0.5f), true);
    addQuad(soup, {0.4137f, 0.f, 0.f}, {0.f, 0.f, 0.5f}, {lean, 0.5f, 0.f});
    const VoxelStructures s = buildVoxelStructures(soup, 48);
    const std::vector<Row> rows = rowsOf(s);
    /// −1, +1: before or behind the wall, by more than a voxel's mixing of the two; 0: in between.
    const auto side = [&](uint32_t face) {
      const vec3 p = s.facePosition(face) * s.grid.h + s.grid.origin;
      const vec3 n = shared::decodeNormal(s.faces[face].normal);
      const float wall = 0.4137f + lean * p.y / 0.5f;
      const float away = p.x - wall + 0.01f * n.x;
      return std::abs(p.x - wall) < 0.03f && std::abs(n.x) < 0.8f ? 0 : (away > 0.f ? 1 : -1);
    };
    double leaks = 0, escapes = 0, count = 0;
    for (uint32_t face = 0; face < s.faces.size(); ++face) {
      const vec3 fromMiddle = s.facePosition(face) - 0.5f * vec3(s.grid.size);
      const vec3 n = shared::decodeNormal(s.faces[face].normal);
      const vec3 p = glm::abs(fromMiddle) - 0.5f * vec3(s.grid.size) + 1.f;
      const bool onBox = p.x > 0.f || p.y > 0.f || p.z > 0.f;
      const int own = side(face);
      if (own == 0 || (onBox && glm::dot(fromMiddle * glm::abs(n), n) > 0.f)) continue;
      leaks += shareOf(rows[face], [&](uint32_t hit) { return side(hit) == -own; });
      escapes += missesOf(rows[face]);
      ++count;
    }
    ASSERT_GT(count, 1000);
    RecordProperty(lean > 0.f ? "leaks_aslant" : "leaks_straight", std::to_string(leaks / count));
    RecordProperty(lean > 0.f ? "escapes_aslant" : "escapes_straight", std::to_string(escapes / count));
    EXPECT_LT(leaks / count, 2e-3) << lean;
    EXPECT_LT(escapes / count, 1e-3) << lean;
  }
}

TEST_F(VisibilityQualityTest, SlowStairsAgreeWithExactRays) {
  // Convex and concave edges aslant in the grid's voxels; the room has blocks and corners.
  Soup stairs;
  for (int i = 0; i < 5; ++i) {
    const float a = static_cast<float>(i) / 5.3f, b = static_cast<float>(i + 1) / 5.3f;
    addQuad(stairs, {a, 0.6f * a, 0.f}, {0.f, 0.f, 1.f}, {0.f, 0.6f * (b - a), 0.f});
    addQuad(stairs, {a, 0.6f * b, 0.f}, {0.f, 0.f, 1.f}, {b - a, 0.f, 0.f});
  }
  const std::vector<uint32_t> directions = clustered_voxel::makeDirections(8);  // 16 sets: 128
  for (const auto& [soup, name] : {std::pair(stairs, "stairs"), std::pair(oracle::roomSoup(), "room")}) {
    const VoxelStructures s = buildVoxelStructures(soup, 32);
    const std::vector<Row> rows = rowsOf(s);
    double area = 0, bias = 0, square = 0, exactSum = 0;
    for (uint32_t face = 0; face < s.faces.size(); face += 7) {
      const double exact = exactMisses(soup, s, face, directions);
      const double error = missesOf(rows[face]) - exact;
      area += s.faces[face].area;
      exactSum += s.faces[face].area * exact;
      bias += s.faces[face].area * error;
      square += s.faces[face].area * error * error;
    }
    EXPECT_GT(exactSum / area, 0.2) << name;
    EXPECT_NEAR(bias / area, 0.0, 0.01) << name;
    EXPECT_LT(std::sqrt(square / area), 0.05) << name;
    RecordProperty(std::string(name) + "_bias", std::to_string(bias / area));
    RecordProperty(std::string(name) + "_rmse", std::to_string(std::sqrt(square / area)));
  }
}

}  // namespace
}  // namespace radivox
