// Built-in scenes against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <map>

#include "engine/scene/builtin.h"
#include "engine/scene/geometry.h"
#include "tests/gpu/expect_error.h"

namespace radivox::tests {
namespace {

using scene::loadScene;
using scene::Scene;

constexpr double kPi = glm::pi<double>();

/// Of a closed surface whose fronts look outwards; negative where they look inwards.
double signedVolume(const Scene& s) {
  double volume = 0;
  for (size_t t = 0; t < s.triangleCount(); ++t) {
    const auto at = [&](size_t k) { return glm::dvec3(s.vertices[s.indices[t * 3 + k]].position); };
    volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  return volume;
}

/// Every edge, taken by position, is walked once in each direction.
void expectWatertight(const Scene& s) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;
  const auto point = [&](uint32_t i) {
    return Point{s.vertices[i].position.x + 0.f, s.vertices[i].position.y + 0.f, s.vertices[i].position.z + 0.f};
  };
  for (size_t i = 0; i < s.indices.size(); ++i) {
    const size_t next = i % 3 == 2 ? i - 2 : i + 1;
    ++edges[{point(s.indices[i]), point(s.indices[next])}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.count({edge.second, edge.first})) << edge.first[0] << " " << edge.first[1] << " " << edge.first[2];
  }
}

TEST(BuiltinTest, EverySceneIsSound) {
  for (const auto& info : scene::builtinScenes()) {
    SCOPED_TRACE(info.name);
    EXPECT_FALSE(info.help.empty());
    const Scene s = scene::makeBuiltin(info.name);
    EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
    EXPECT_EQ(s.indices.size(), s.triangleMaterials.size() * 3);
    for (const uint32_t i : s.indices) ASSERT_LT(i, s.vertices.size());
    for (const uint32_t m : s.triangleMaterials) ASSERT_LT(m, s.materials.size());
    ASSERT_EQ(s.materials.size(), s.materialNames.size());
    ASSERT_GE(s.materials.size(), 1u);
    for (const auto& v : s.vertices) {
      ASSERT_NEAR(glm::length(v.normal), 1, 1e-5);
      ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
    }
    for (const auto& m : s.materials) {
      for (glm::length_t c = 0; c < 3; ++c) {
        EXPECT_GE(m.albedo[c], 0.f);
        EXPECT_LE(m.albedo[c], 0.999f);
      }
    }
    // Shading normals lean to the front.
    for (size_t t = 0; t < s.triangleCount(); ++t) {
      const glm::dvec3 n = scene::areaVector(s, t);
      for (size_t k = 0; k < 3; ++k) ASSERT_GT(glm::dot(n, glm::dvec3(s.vertices[s.indices[t * 3 + k]].normal)), 0) << "triangle " << t;
    }
    ASSERT_GE(s.cameras.size(), 1u);
    for (const auto& camera : s.cameras) {
      EXPECT_GT(camera.znear, 0.f);
      EXPECT_FALSE(camera.name.empty());
    }
    EXPECT_EQ(s.traits().lit(), info.name != "empty");
    EXPECT_EQ(s.origin, glm::dvec3(0.0));
    // The parameters that the help names exist, with those defaults.
    std::map<std::string, std::string> defaults;
    for (const auto& p : info.parameters) defaults[p.substr(0, p.find('='))] = p.substr(p.find('=') + 1);
    EXPECT_EQ(scene::makeBuiltin(info.name, defaults).indices, s.indices);
  }
}

TEST(BuiltinTest, SameBitsEachTime) {
  for (const char* name : {"builtin:atrium?triangles=30000", "builtin:sphere", "builtin:two_rooms"}) {
    const Scene a = loadScene(name), b = loadScene(name);
    EXPECT_EQ(a.indices, b.indices);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(shared::Vertex)), 0);
  }
}

TEST(BuiltinTest, ClosedScenesAreWatertightWithTheirVolume) {
  struct Case {
    const char* scene;
    double volume;  ///< negative: seen from inside
    double area;
    double tolerance;
  };
  const double rooms = -(2 * 4 * 3 * 4.0), door = 2.1 * 0.2;  // the passage's volume for each metre of width
  const auto stairArea = [](double n) { return 2 * 0.29 * 0.17 * n * (n + 1) / 2 + 1.5 * n * (0.17 + 0.29) * 2; };
  const Case cases[] = {{"builtin:box", -1, 6, 1e-6},
                        {"builtin:box?subdivisions=7", -1, 6, 1e-5},
                        {"builtin:furnace?subdivisions=3", -8, 24, 1e-5},
                        {"builtin:two_rooms?door=0", rooms, 2 * (2 * (4 * 3 + 3 * 4 + 4 * 4)), 1e-4},
                        {"builtin:two_rooms", rooms - door, 160 - 2 * 2.1 + 0.2 * (2 * 2.1 + 2), 1e-4},
                        {"builtin:two_rooms?door=2.5", rooms - 2.5 * door, 160 - 2 * 2.5 * 2.1 + 0.2 * (2 * 2.1 + 2 * 2.5), 1e-4},
                        {"builtin:sphere?rings=48", 4.0 / 3 * kPi, 4 * kPi, 0.01},
                        {"builtin:sphere?rings=48&inward=1&radius=2", -32.0 / 3 * kPi, 16 * kPi, 0.04},
                        {"builtin:staircase?steps=6", 1.5 * 0.29 * 0.17 * 21, stairArea(6), 1e-5}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.scene);
    const Scene s = loadScene(c.scene);
    expectWatertight(s);
    EXPECT_NEAR(signedVolume(s), c.volume, c.tolerance * 3);
    EXPECT_NEAR(s.traits().surfaceArea, c.area, c.tolerance * 10);
  }
}

TEST(BuiltinTest, AreasAndBounds) {
  EXPECT_NEAR(loadScene("builtin:plane?size=3&subdivisions=5").traits().surfaceArea, 9, 1e-5);
  EXPECT_NEAR(loadScene("builtin:ramp?angle=33").traits().surfaceArea, 16, 1e-5);
  EXPECT_EQ(loadScene("builtin:thin_wall").triangleCount(), 2u);
  EXPECT_NEAR(loadScene("builtin:thin_wall").traits().surfaceArea, 4, 1e-6);
  EXPECT_EQ(loadScene("builtin:empty").triangleCount(), 0u);
  const Scene cornell = loadScene("builtin:cornell");
  const auto traits = cornell.traits();
  EXPECT_EQ(traits.emissiveTriangleCount, 2u);
  EXPECT_NEAR(traits.emissiveArea, 1.3 * 1.1, 1e-5);
  EXPECT_FALSE(traits.emittersByRays);
  for (size_t t = 0; t < cornell.triangleCount(); ++t) {
    if ((cornell.materials[cornell.triangleMaterials[t]].flags & shared::kMaterialEmissive) != 0u) {
      EXPECT_LT(scene::areaVector(cornell, t).y, 0);  // shines down
    }
  }
}

TEST(BuiltinTest, FurnaceIsBalanced) {
  for (const char* albedo : {"0", "0.5", "0.9", "0.999"}) {
    const Scene s = scene::makeBuiltin("furnace", {{"albedo", albedo}});
    const auto& m = s.materials[0];
    for (glm::length_t c = 0; c < 3; ++c) EXPECT_NEAR(m.albedo[c] * 1.0 + kPi * m.emission[c], 1.0, 1e-6);  // B = ρE + πL_e with E = 1
    EXPECT_TRUE(s.traits().emittersByRays);
  }
}

TEST(BuiltinTest, ScaleAndOffsetKeepIrradiance) {
  const Scene s = loadScene("builtin:cornell_point"), large = loadScene("builtin:cornell_point?scale=100"),
              far = loadScene("builtin:cornell_point?offset=2e6");
  EXPECT_NEAR(large.traits().surfaceArea, 1e4 * s.traits().surfaceArea, 1);
  EXPECT_NEAR(large.lights[0].intensity.x / s.lights[0].intensity.x, 1e4, 1e-2);
  EXPECT_LT(glm::length(far.origin - glm::dvec3(2e6)), 10.0);
  // All of it moved as one.
  for (size_t i = 0; i < s.vertices.size(); ++i) {
    const glm::dvec3 moved = far.origin + glm::dvec3(far.vertices[i].position) - glm::dvec3(s.vertices[i].position);
    EXPECT_LT(glm::length(moved - glm::dvec3(2e6)), 1e-5);
  }
  EXPECT_LT(glm::length(far.origin + glm::dvec3(far.lights[0].position) - glm::dvec3(s.lights[0].position) - glm::dvec3(2e6)), 1e-5);
}

TEST(BuiltinTest, Errors) {
  const auto failure = [](const char* name, const std::string& part) {
    expectError(catchError([&] { loadScene(name); }), ErrorCode::BadInput, part);
  };
  failure("builtin:cornel", "did you mean builtin:cornell?");
  failure("builtin:", "no such scene");
  failure("builtin:zzzzzzzz", "there are: atrium, cornell");
  failure("builtin:furnace?albdo=0.3", "did you mean \"albedo\"?");
  failure("builtin:furnace?albedo=1", "albedo=1 should be a number from 0 to 0.999");
  failure("builtin:furnace?albedo=", "should be a number");
  failure("builtin:furnace?albedo=nan", "should be a number");
  failure("builtin:furnace?albedo=0.5x", "should be a number");
  failure("builtin:furnace?albedo", "is no parameter");
  failure("builtin:furnace?albedo=0.1&albedo=0.2", "given twice");
  failure("builtin:box?subdivisions=1.5", "whole number");
  failure("builtin:atrium?triangles=1e9", "from 2000 to 5e+06");
  failure("atrium", "write builtin:atrium");
  failure("", "no scene is named");
}

TEST(AtriumTest, TriangleCounts) {
  for (const double target : {2000.0, 4000.0, 6200.0, 9000.0, 25000.0, 60000.0, 200000.0}) {
    const Scene s = scene::makeBuiltin("atrium", {{"triangles", std::to_string(target)}});
    EXPECT_NEAR(static_cast<double>(s.triangleCount()), target, 0.2 * target);
    EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
    EXPECT_EQ(s.cameras.size(), 2u);
    EXPECT_EQ(s.cameras[0].name, "court");
  }
}

/// The largest fits a 128 MiB binding, the least that devices offer.
TEST(AtriumTest, SlowFiveMillionTriangles) {
  const Scene s = loadScene("builtin:atrium?triangles=5000000");
  EXPECT_NEAR(static_cast<double>(s.triangleCount()), 5e6, 1e6);
  EXPECT_LE(s.vertices.size() * sizeof(shared::Vertex), 128u << 20);
}

/// From the court, in any direction, one meets the front of something or the sky: nothing is missing or inside out.
TEST(AtriumTest, NoCracksFromTheCourt) {
  const Scene s = loadScene("builtin:atrium?triangles=25000");
  const glm::dvec3 eye(9.0, 2.0, 4.2);
  size_t sky = 0, backs = 0;
  uint32_t random = 1;
  const auto next = [&] {
    random = random * 1664525u + 1013904223u;
    return (random >> 8) * (1.0 / (1 << 24));
  };
  constexpr int kRays = 600;
  for (int r = 0; r < kRays; ++r) {
    const double y = 2 * next() - 1, a = 2 * kPi * next(), h = std::sqrt(1 - y * y);
    const glm::dvec3 d(h * std::cos(a), y, h * std::sin(a));
    double nearest = 1e30;
    size_t hit = s.triangleCount();
    for (size_t t = 0; t < s.triangleCount(); ++t) {
      const auto at = [&](size_t k) { return glm::dvec3(s.vertices[s.indices[t * 3 + k]].position); };
      const glm::dvec3 e1 = at(1) - at(0), e2 = at(2) - at(0), q = glm::cross(d, e2);
      const double determinant = glm::dot(e1, q);
      if (std::abs(determinant) < 1e-14) continue;
      const glm::dvec3 o = eye - at(0);
      const double u = glm::dot(o, q) / determinant, v = glm::dot(d, glm::cross(o, e1)) / determinant;
      const double distance = glm::dot(e2, glm::cross(o, e1)) / determinant;
      if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest) continue;
      nearest = distance;
      hit = t;
    }
    if (hit == s.triangleCount()) {
      ++sky;
      EXPECT_GT(y, 0.2) << "a ray leaves below the roof: " << d.x << " " << d.y << " " << d.z;
      continue;
    }
    const bool twoSided = (s.materials[s.triangleMaterials[hit]].flags & shared::kMaterialDoubleSided) != 0u;
    if (!twoSided && glm::dot(scene::areaVector(s, hit), d) > 0) ++backs;
  }
  EXPECT_EQ(backs, 0u);
  EXPECT_GT(sky, kRays / 12);
}

}  // namespace
}  // namespace radivox::tests
