// A sealed room in bright sun: no light comes in, whatever its walls and however it is turned.
#include <gtest/gtest.h>

#include <cstdio>
#include <glm/gtc/quaternion.hpp>

#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/voxel_structures.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

constexpr uint32_t kResolution = 32;
constexpr float kRoom = 4.f;  // m, inside
constexpr float kSun = 10.f;  // W/m²

class Leaks : public oracles::GpuTest {};

/// `wall` in voxels; 0: a single sheet whose front is inside. The room is turned by `angle` about a slanted axis; a floor to reflect sun is outside.
scene::Scene sealedRoom(float wall, float angle) {
  // Bounds grow with the turn: take the largest voxel edge that they can have.
  const float h = kRoom * 1.8f / (kResolution - 1);
  const float thick = wall * h;
  oracle::Soup soup;
  oracle::addBox(soup, glm::vec3(-0.5f * kRoom), glm::vec3(0.5f * kRoom), glm::vec3(0.5f), true);
  if (wall > 0) oracle::addBox(soup, glm::vec3(-0.5f * kRoom - thick), glm::vec3(0.5f * kRoom + thick), glm::vec3(0.5f), false);
  const glm::quat turn = glm::angleAxis(angle, glm::normalize(glm::vec3(0.3f, 1.f, 0.2f)));
  for (oracle::SoupTriangle& t : soup)
    for (int c = 0; c < 3; ++c) {
      t.position[c] = turn * t.position[c];
      t.normal[c] = turn * t.normal[c];
    }
  scene::Scene s = oracle::sceneOf(soup);
  s.lights.clear();
  scene::PunctualLight sun;
  sun.direction = glm::normalize(glm::vec3(0.5f, -1.f, 0.3f));
  sun.intensity = glm::vec3(kSun);
  s.lights.push_back(sun);
  return s;
}

/// Greatest and mean irradiance (direct and indirect) of what a wide camera in the middle of the room sees.
std::pair<double, double> lightInside(const scene::Scene& scene, const std::string& graph, const std::string& indirect,
                                      const glm::quat& look) {
  PipelineOptions options;
  options.graph = graph;
  options.width = options.height = 32;
  options.settings = {{"voxelize.resolution", std::to_string(kResolution)}};
  options.outputs = {"direct.irradiance", indirect};
  Pipeline p(oracles::sharedDevice(), scene, options);
  scene::CameraDescription camera;
  camera.orientation = look;
  camera.yfov = 1.8f;
  p.setCamera(camera);
  p.run();
  const image::Image direct = p.picture("direct.irradiance"), bounced = p.picture(indirect);
  double sum = 0, most = 0;
  for (size_t i = 0; i < direct.data.size(); ++i) {
    const double e = direct.data[i] + bounced.data[i];
    sum += e;
    most = std::max(most, e);
  }
  return {most, sum / static_cast<double>(direct.data.size())};
}

/// What came in when last looked at, with room for half as much again. The aim is 1e-3 of the sun: voxels on the edges of the room still mix what its
/// walls show inside with what their neighbours show outside.
void expectSealed(const std::string& graph, const std::vector<float>& walls, int angles, double most) {
  const std::string indirect = graph == "clustered_voxel" ? "shade.irradiance" : "gather_pixels.irradiance";
  for (const float wall : walls) {
    double worst = 0, mean = 0;
    for (int a = 0; a < angles; ++a) {
      const float angle = 0.05f + 6.2831853f * static_cast<float>(a) / static_cast<float>(angles) / 4;
      // Towards a corner, and the next one.
      const glm::quat look = glm::angleAxis(0.8f + 1.5707963f * static_cast<float>(a), glm::vec3(0, 1, 0));
      const auto [greatest, average] = lightInside(sealedRoom(wall, angle), graph, indirect, look);
      worst = std::max(worst, average);
      mean += average / angles;
    }
    std::printf("%-24s wall %.2f h: irradiance inside, mean %.2e, worst angle %.2e of the sun's\n", graph.c_str(),
                static_cast<double>(wall), mean / static_cast<double>(kSun), worst / static_cast<double>(kSun));
    EXPECT_LE(worst, most * static_cast<double>(kSun)) << graph << ", walls of " << wall << " voxels";
  }
}

TEST_F(Leaks, SlowLittleLightComesIntoASealedRoom) {
  expectSealed("clustered_voxel_pixels", {0.f, 0.25f, 0.5f, 1.f, 2.f}, 3, 4e-3);
  expectSealed("clustered_voxel", {0.f, 1.f}, 3, 8e-3);
}

}  // namespace
}  // namespace radivox
