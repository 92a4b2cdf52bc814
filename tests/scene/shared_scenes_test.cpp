// The development scenes, where they are there: $RADIVOX_SHARED or ../shared beside the source.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "engine/scene/scene.h"

namespace radivox::tests {
namespace {

using scene::Scene;

class SharedScenesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* fromEnvironment = std::getenv("RADIVOX_SHARED");
    folder_ = fromEnvironment != nullptr ? fromEnvironment : std::string(RADIVOX_SOURCE_DIR) + "/../shared";
    if (!std::filesystem::exists(folder_ + "/scenes/sponza.glb")) GTEST_SKIP() << "no shared scenes at " << folder_;
  }
  Scene load(const std::string& name) { return scene::loadScene(folder_ + "/scenes/" + name); }
  std::string folder_;
};

TEST_F(SharedScenesTest, Sponza) {
  const Scene s = load("sponza.glb");
  EXPECT_EQ(s.triangleCount(), 66453u);
  EXPECT_EQ(s.materials.size(), 12u);
  EXPECT_TRUE(s.textures.empty());
  EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
  EXPECT_EQ(s.origin, glm::dvec3(0.0));
  const auto traits = s.traits();
  EXPECT_LT(glm::length(traits.boundsMin - glm::vec3(-17.40f, -0.91f, -7.80f)), 0.01f);
  EXPECT_LT(glm::length(traits.boundsMax - glm::vec3(17.42f, 15.65f, 7.80f)), 0.01f);
  ASSERT_EQ(s.lights.size(), 1u);
  EXPECT_EQ(s.lights[0].type, shared::kLightDirectional);
  EXPECT_EQ(s.lights[0].intensity, glm::vec3(10.f));
  EXPECT_LT(glm::length(s.lights[0].direction - glm::normalize(glm::vec3(0.62f, -1.f, 0.19f))), 1e-4f);
  ASSERT_EQ(s.cameras.size(), 1u);
  EXPECT_LT(glm::length(s.cameras[0].position - glm::vec3(-9.7f, 1.75f, -1.15f)), 1e-4f);
  EXPECT_NEAR(s.cameras[0].yfov * 180 / 3.14159265, 58, 0.01);
  for (const auto& vertex : s.vertices) ASSERT_NEAR(glm::length(vertex.normal), 1, 1e-5);
}

TEST_F(SharedScenesTest, SponzaWithCurtains) {
  const Scene s = load("sponza_curtains.glb");
  EXPECT_EQ(s.triangleCount(), 66473u);
  EXPECT_EQ(s.materials.size(), 15u);
}

TEST_F(SharedScenesTest, Cornell) {
  const Scene s = load("cornell.glb");
  EXPECT_EQ(s.triangleCount(), 32u);
  const auto traits = s.traits();
  EXPECT_EQ(traits.emissiveTriangleCount, 2u);
  EXPECT_FALSE(traits.emittersByRays);
  bool found = false;
  for (const auto& m : s.materials) found = found || m.emission == glm::vec3(17, 12, 4);
  EXPECT_TRUE(found);
  const Scene point = load("cornell_point.glb");
  EXPECT_EQ(point.triangleCount(), 30u);
  ASSERT_EQ(point.lights.size(), 1u);
  EXPECT_LT(glm::length(point.lights[0].position - glm::vec3(2.78f, 4.90f, 2.795f)), 1e-5f);
  EXPECT_LT(glm::length(point.lights[0].intensity - 12.f * glm::vec3(1, 0.706f, 0.235f)), 0.01f);
}

}  // namespace
}  // namespace radivox::tests
