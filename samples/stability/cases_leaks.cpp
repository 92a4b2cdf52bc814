// Walls thinner than voxels: no light comes through them, and they take none away.
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/text.h"
#include "samples/stability/cases.h"
#include "samples/stability/scenes.h"

namespace radivox::stability {

namespace {

constexpr uint32_t kResolution = 32;
constexpr double kRoom = 4;  // m, inside
constexpr float kSun = 10.f;
constexpr int kAngles = 12;
constexpr const char* kMixed = "a voxel on the room's edge mixes what one wall shows inside with what the next one shows outside";

/// A closed room of one-sided walls, `wall` voxels thick (0: one sheet, whose front is inside), turned about a slanted axis. A camera in its middle
/// looks into a corner, the next one at the next angle.
scene::Scene sealedRoom(double wall, int angle, bool sunny) {
  // Bounds grow with the turn: the largest voxel edge that they can have.
  const double thick = wall * kRoom * 1.8 / (kResolution - 1);
  SceneMaker make("sealed room");
  const uint32_t material = make.addMaterial(0.5f);
  make.addRoom(glm::dvec3(-kRoom / 2), glm::dvec3(kRoom / 2), material);
  if (wall > 0) make.addBlock(glm::dvec3(-kRoom / 2 - thick), glm::dvec3(kRoom / 2 + thick), material);
  scene::Scene scene = make.take();
  const glm::quat turn =
      glm::angleAxis(0.05f + glm::half_pi<float>() * static_cast<float>(angle) / kAngles, glm::normalize(glm::vec3(0.3f, 1.f, 0.2f)));
  for (shared::Vertex& vertex : scene.vertices) {
    vertex.position = turn * vertex.position;
    vertex.normal = turn * vertex.normal;
  }
  SceneMaker lit("light");
  if (sunny)
    lit.addSun({0.5, -1, 0.3}, kSun);
  else
    lit.addLamp({0.2, 0.3, -0.1}, 5.f);
  scene.lights = lit.take().lights;
  scene.cameras = {makeCameraAt({0, 0, 0}, {angle % 2 == 0 ? 1 : -1, angle % 3 - 1, angle % 4 < 2 ? 1 : -1}, 1.8f)};
  return scene;
}

RenderOptions inside() {
  RenderOptions options = coarse(kResolution);
  options.width = options.height = 32;
  options.aovs = {"irradiance_direct", "irradiance_indirect"};
  return options;
}

/// Irradiance of voxel faces, blended over pixels: what one face has wrong, many pixels show.
bool isInterpolated(const Bench& bench) { return bench.method() == "clustered_voxel"; }

void runSunny(Bench& bench, Row& row, double wall) {
  double worst = 0, sum = 0;
  for (int angle = 0; angle < kAngles; ++angle) {
    const auto render = bench.render(sealedRoom(wall, angle, true), inside());
    const double light = meanOf(render->surfaceValues("irradiance_direct")) + meanOf(render->surfaceValues("irradiance_indirect"));
    worst = std::max(worst, light / double{kSun});
    sum += light / double{kSun};
  }
  row.judge(0, worst, 1e-3);
  row.note = "mean of the " + std::to_string(kAngles) + " angles " + printNumber(sum / kAngles);
}

void runLit(Bench& bench, Row& row, double wall) {
  double worst = 0;
  for (int angle = 0; angle < kAngles; angle += kAngles / 3) {
    // What is outside makes no difference to the light inside.
    const double expected = traceMean(bench, sealedRoom(0, angle, false), inside(), "1024");
    const double light = meanOf(bench.render(sealedRoom(wall, angle, false), inside())->surfaceValues("irradiance_indirect")) / expected;
    if (std::abs(light - 1) > std::abs(worst)) worst = light - 1;
  }
  row.judge(1, 1 + worst, 0.02);
}

}  // namespace

void addLeakCases(Cases& cases) {
  for (const double wall : {2.0, 1.0, 0.5, 0.25, 0.0}) {
    const std::string walls = wall > 0 ? "walls of " + printNumber(wall) + (wall > 1 ? " voxels" : " voxel") : "one-sided sheets for walls";
    cases.push_back({.group = "leaks",
                     .name = "a dark room in the sun, " + walls,
                     .answer = "black: at most 0.1 % of the sun's irradiance, turned by any of 12 angles",
                     .run = [wall](Bench& bench, Row& row) {
                       runSunny(bench, row, wall);
                       if (!isInterpolated(bench)) return;
                       row.bound = 0.03;
                       row.why = kMixed;
                     }});
    cases.push_back({.group = "leaks",
                     .name = "a lit room, " + walls,
                     .answer = "the path tracer's mean: no darkening over 2 %",
                     .run = [wall](Bench& bench, Row& row) {
                       if (!canTrace(bench, row)) {
                         bench.render(sealedRoom(wall, 0, false), inside());
                         return;
                       }
                       runLit(bench, row, wall);
                       if (!isInterpolated(bench)) return;
                       row.bound = 0.25;
                       row.why = kMixed;
                     }});
  }
}

}  // namespace radivox::stability
