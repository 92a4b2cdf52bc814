// Extreme scales, distances and lights.
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "engine/text.h"
#include "samples/stability/cases.h"
#include "samples/stability/scenes.h"

namespace radivox::stability {

namespace {

/// Two closed rooms side by side, a lamp in each; the camera is in the first.
scene::Scene twoClosedRooms(float first, float second) {
  SceneMaker make("two closed rooms");
  const uint32_t wall = make.addMaterial(0.6f);
  make.addRoom({0, 0, 0}, {1, 1, 1}, wall);
  make.addRoom({1.5, 0, 0}, {2.5, 1, 1}, wall);
  if (first > 0) make.addLamp({0.4, 0.7, 0.5}, first);
  if (second > 0) make.addLamp({2.0, 0.7, 0.5}, second);
  make.lookFrom({0.9, 0.3, 0.9}, {0.2, 0.4, 0.1}, 1.2f);
  return make.take();
}

/// What a dim lamp does beside a bright one that it does not see must not drown.
void runRatio(Bench& bench, Row& row, float dim, float bright) {
  const auto alone = bench.render(twoClosedRooms(dim, 0.f), coarse(40))->surfaceValues("irradiance_indirect");
  const auto beside = bench.render(twoClosedRooms(dim, bright), coarse(40))->surfaceValues("irradiance_indirect");
  const double mean = meanOf(alone);
  row.judge(mean, meanOf(beside), bench.tolerance(1e-3), mean);
  if (bench.isNoisy()) {
    row.bound = 1.0;
    row.why = "of the lights one is asked whether it is seen, mostly the brightest: the other room's takes nearly every sample";
  }
  row.error = std::max(row.error, std::abs(std::min(0.0, double{*std::min_element(beside.begin(), beside.end())}) / mean));
}

scene::Scene scaledRoom(double scale) {
  scene::Scene scene = litRoom();
  const auto s = static_cast<float>(scale);
  for (auto& vertex : scene.vertices) vertex.position *= s;
  for (auto& light : scene.lights) {
    light.position *= s;
    light.intensity *= s * s;
  }
  for (auto& camera : scene.cameras) {
    camera.position *= s;
    camera.znear *= s;
  }
  return scene;
}

/// With 32 voxels a side the block's front, in the middle of the room, would lie on the border of two voxels.
constexpr uint32_t kNoPlaneOnABorder = 33;

scene::Scene withIntensity(float intensity) {
  scene::Scene scene = litRoom();
  for (auto& light : scene.lights) light.intensity = glm::vec3(intensity);
  return scene;
}

void runIntensity(Bench& bench, Row& row, float intensity) {
  const auto one = bench.render(withIntensity(1.f), coarse())->surfaceValues("irradiance_indirect");
  auto values = bench.render(withIntensity(intensity), coarse())->surfaceValues("irradiance_indirect");
  for (float& value : values) value /= intensity;
  row.expected = meanOf(one);
  row.result = meanOf(values);
  row.error = relativeRmse(one, values);
  row.tolerance = 1e-3;
}

scene::Scene withLampAt(const glm::vec3& position) {
  scene::Scene scene = litRoom();
  scene.lights[0].position = position;
  return scene;
}

/// `count` lamps where one was, each a share of it.
scene::Scene manyLamps(uint32_t count) {
  scene::Scene scene = litRoom();
  scene::PunctualLight lamp = scene.lights[0];
  lamp.intensity /= static_cast<float>(count);
  scene.lights.assign(count, lamp);
  return scene;
}

void runManyLamps(Bench& bench, Row& row, uint32_t count) {
  RenderOptions options = coarse(24);
  options.width = 24;
  options.height = 16;
  options.lights.pointShadowResolution = 64;
  compareScenes(bench, row, litRoom(), manyLamps(count), options, bench.tolerance(1e-3));
}

/// A ceiling of many small emitters against one large one.
scene::Scene emittingCeiling(uint32_t parts) {
  SceneMaker make("ceiling");
  const uint32_t wall = make.addMaterial(0.5f), lamp = make.addMaterial(0.5f, 1.f);
  make.addRoom(glm::dvec3(-1), glm::dvec3(1), wall);
  make.addPatch({-0.3, 0.9, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, parts, parts, lamp);
  make.lookFrom({0.5, 0.2, 0.9}, {-0.3, -0.4, -0.8}, 1.2f);
  return make.take();
}

void runManyEmitters(Bench& bench, Row& row) {
  RenderOptions options = coarse(24);
  options.aovs = {"irradiance_indirect", "irradiance_direct"};
  compareScenes(bench, row, emittingCeiling(1), emittingCeiling(224), options, 0.05);
}

}  // namespace

void addLightCases(Cases& cases) {
  for (const double scale : {std::exp2(-13.0), std::exp2(19.0)}) {
    cases.push_back({.group = "extreme",
                     .name = "scale " + printNumber(scale) + ", a power of two",
                     .answer = "the picture of scale 1, bit for bit",
                     .run = [scale](Bench& bench, Row& row) {
                       compareScenes(bench, row, litRoom(), scaledRoom(scale), coarse(), bench.tolerance(0));
                     }});
  }
  for (const double scale : {1e-4, 1e-2, 1e2, 1e4, 1e6}) {
    cases.push_back({.group = "extreme",
                     .name = "scale " + printNumber(scale),
                     .answer = "the picture of scale 1 (intensities grow with the square)",
                     .run =
                         [scale](Bench& bench, Row& row) {
                           compareScenes(bench, row, litRoom(), scaledRoom(scale), coarse(kNoPlaneOnABorder), bench.tolerance(5e-3));
                         },
                     .fast = scale == 1e6});
  }
  cases.push_back({.group = "extreme",
                   .name = "scale 10000, a plane on the border of two voxels",
                   .answer = "the picture of scale 1 (intensities grow with the square)",
                   .run = [](Bench& bench, Row& row) {
                     compareScenes(bench, row, litRoom(), scaledRoom(1e4), coarse(32), bench.tolerance(2e-3));
                     row.bound = 0.08;
                     row.why = "numbers round differently, and the plane is on the other side of the border";
                   }});
  cases.push_back(
      {.group = "extreme", .name = "1e6 m from the origin", .answer = "the picture at the origin", .run = [](Bench& bench, Row& row) {
         compareScenes(bench, row, scene::makeBuiltin("cornell_point"), scene::makeBuiltin("cornell_point", {{"offset", "1000000"}}),
                       coarse(), 2e-3);
       }});
  for (const float intensity : {1e-6f, 1e9f}) {
    cases.push_back({.group = "extreme",
                     .name = "a lamp of " + printNumber(static_cast<double>(intensity)) + " W/sr",
                     .answer = "that many times the light of 1 W/sr",
                     .run = [intensity](Bench& bench, Row& row) { runIntensity(bench, row, intensity); },
                     .fast = intensity > 1.f});
  }
  cases.push_back({.group = "extreme",
                   .name = "lamps of 1 and 1e9 W/sr in rooms apart",
                   .answer = "the dim room as it is without the bright one",
                   .run = [](Bench& bench, Row& row) { runRatio(bench, row, 1.f, 1e9f); },
                   .fast = true});
  cases.push_back({.group = "extreme",
                   .name = "lamps of 1e-6 and 1e9 W/sr in rooms apart",
                   .answer = "the dim room as it is without the bright one",
                   .run = [](Bench& bench, Row& row) {
                     runRatio(bench, row, 1e-6f, 1e9f);
                     row.bound = 1.0;
                     row.why = "sums are in fixed point by the brightest light: of one 1e15 times dimmer nothing is left, and none is made";
                   }});
  cases.push_back({.group = "extreme", .name = "a lamp inside a block", .answer = "the room is black", .run = [](Bench& bench, Row& row) {
                     // Against the radiance inside, where the walls are 0.3 m away.
                     expectBlack(bench, row, withLampAt({-0.4f, -0.5f, -0.3f}), coarse());
                     row.error /= 0.6 / glm::pi<double>() / (0.3 * 0.3);
                     row.bound = 0.1;
                     row.why = "rays of voxels at the block's edges pass beside its corners: the share of the light inside that leaks";
                   }});
  cases.push_back(
      {.group = "extreme",
       .name = "a lamp at a vertex",
       .answer = "as much indirect light as 1 mm beside it, where both see the room: at most twice, and finite",
       .run = [](Bench& bench, Row& row) {
         const auto beside = bench.render(withLampAt({-0.099f, -0.099f, 0.001f}), coarse())->surfaceValues("irradiance_indirect");
         const auto at = bench.render(withLampAt({-0.1f, -0.1f, 0.f}), coarse())->surfaceValues("irradiance_indirect");
         row.judge(meanOf(beside), meanOf(at), 0.05, meanOf(beside));
         row.bound = 1.0;
         row.why = "which of the faces about the vertex it lights is rounding";
       }});
  cases.push_back({.group = "extreme",
                   .name = "300 lamps in one place",
                   .answer = "the picture of one lamp of their sum",
                   .run = [](Bench& bench, Row& row) { runManyLamps(bench, row, 300); }});
  cases.push_back({.group = "extreme",
                   .name = "1e5 lamps",
                   .answer = "the picture of one lamp of their sum, or how many fit",
                   .run = [](Bench& bench, Row& row) { runManyLamps(bench, row, 100000); },
                   .fast = true,
                   .mayRefuse = true});
  cases.push_back(
      {.group = "extreme", .name = "1e5 emissive triangles", .answer = "the picture of one emissive square", .run = runManyEmitters});
}

}  // namespace radivox::stability
