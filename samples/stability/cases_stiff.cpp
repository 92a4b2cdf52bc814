// Stiff: light that takes long to settle, or passes through next to nothing.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "engine/text.h"
#include "samples/stability/cases.h"
#include "samples/stability/scenes.h"

namespace radivox::stability {

namespace {

/// Every wall emits (1 − ρ)/π: B = 1, and ρ of it has been reflected before.
void runFurnace(Bench& bench, Row& row, double albedo) {
  RenderOptions options = coarse(16);
  options.settings.push_back({"bounce.residual", "1e-7"});
  const auto render = bench.render(scene::makeBuiltin("furnace", {{"albedo", printNumber(albedo)}}), options);
  const auto values = render->surfaceValues("irradiance_indirect");
  row.judge(albedo, meanOf(values), bench.tolerance(2e-4));
  // Noise averages out of the mean only; what is exact is exact in every pixel.
  if (!bench.isNoisy()) row.error = largestFrom(values, albedo);
}

/// Two plates of side 1, a hundredth of a voxel apart; the lower one emits upwards. E_low = ρ E_up, E_up = π L_e + ρ E_low.
scene::Scene makePlates(double gap, bool emits) {
  SceneMaker make("plates");
  const uint32_t white = make.addMaterial(0.9f), lamp = make.addMaterial(0.9f, emits ? 1.f : 0.f);
  make.addQuad({0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}, lamp);
  make.addQuad({0, gap, 0}, {1, gap, 0}, {1, gap, 1}, {0, gap, 1}, white);
  return make.take();
}

void runPlates(Bench& bench, Row& row) {
  constexpr double kAlbedo = 0.9;
  const double gap = 0.01 / 31.0;
  scene::Scene scene = makePlates(gap, true);
  // Level between the plates: half of the pixels see either.
  scene.cameras = {makeCameraAt({0.2, 0.5 * gap, 0.5}, {0.8, 0.5 * gap, 0.5}, 0.05f)};
  scene.cameras[0].znear = static_cast<float>(gap);
  const auto render = bench.render(scene, coarse(32));
  const auto values = render->surfaceValues("irradiance_indirect");
  const double up = glm::pi<double>() / (1.0 - kAlbedo * kAlbedo), low = kAlbedo * up;
  const double expected = 0.5 * (low + up - glm::pi<double>());
  row.judge(expected, meanOf(values), bench.tolerance(0.1), expected);
  row.bound = 1.0;
  row.why = "surfaces nearer to each other than a voxel share its faces: light between them is lost, and none is made";
}

void runPlatesLitFromOutside(Bench& bench, Row& row) {
  scene::Scene scene = makePlates(0.01 / 31.0, false);
  SceneMaker sun("sun");
  sun.addSun({0.1, -1, 0.2}, 10.f);
  scene.lights = sun.take().lights;
  scene.cameras = {makeCameraAt({0.5, -1, 0.6}, {0.5, 0, 0.5}, 0.8f)};
  expectBlack(bench, row, scene, coarse(32));
}

scene::Scene makeCorridor() {
  SceneMaker make("corridor");
  const uint32_t wall = make.addMaterial(0.8f);
  make.addRoom({0, 0, 0}, {20, 1, 1}, wall);
  make.addLamp({0.5, 0.5, 0.5}, 1.f);
  // The far end: light gets there by some twenty bounces.
  make.lookFrom({18.2, 0.5, 0.5}, {20, 0.5, 0.5}, 0.5f);
  return make.take();
}

/// The path tracer's own noise is within `tolerance`.
void runAgainstPathTracer(Bench& bench, Row& row, const scene::Scene& scene, const RenderOptions& options, const char* spp,
                          double tolerance) {
  if (!canTrace(bench, row)) {
    bench.render(scene, options);
    return;
  }
  RenderOptions small = coarse();
  small.width = 24;
  small.height = 16;
  const double expected = traceMean(bench, scene, small, spp);
  const auto values = bench.render(scene, options)->surfaceValues("irradiance_indirect");
  row.judge(expected, meanOf(values), tolerance, expected);
}

}  // namespace

RenderOptions coarse(uint32_t resolution) {
  RenderOptions options;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)},
                      {"visibility.rays", "64"},
                      {"gather_pixels.rays", "16"},
                      {"path_trace.spp", "64"}};
  return options;
}

bool canTrace(const Bench& bench, Row& row) {
  if (bench.hasGraph("reference")) return true;
  row.shown = true;
  row.note = "this build has no path tracer to know the answer from";
  return false;
}

double traceMean(Bench& bench, const scene::Scene& scene, RenderOptions options, const char* spp) {
  options.graph = "reference";
  options.aovs = {"irradiance_indirect"};
  options.settings = {{"path_trace.spp", spp}, {"path_trace.seed", "77"}};
  return meanOf(bench.render(scene, options)->surfaceValues("irradiance_indirect"));
}

void compareScenes(Bench& bench, Row& row, scene::Scene reference, scene::Scene test, const RenderOptions& options, double tolerance,
                   const std::string& aov) {
  const auto first = bench.render(std::move(reference), options), second = bench.render(std::move(test), options);
  const auto expected = first->surfaceValues(aov), values = second->surfaceValues(aov);
  row.expected = meanOf(expected);
  row.result = meanOf(values);
  // Two noisy pictures differ in every pixel.
  row.error = bench.isNoisy() && row.expected > 0 ? std::abs(row.result - row.expected) / row.expected : relativeRmse(expected, values);
  row.tolerance = tolerance;
  if (expected.empty()) row.error = 1e30;  // nothing was seen: no case
  if (row.error > tolerance) row.note = second->describeWorst(aov, first->aov(aov));
}

void expectBlack(Bench& bench, Row& row, scene::Scene scene, RenderOptions options, double tolerance) {
  options.aovs = {"color", "direct", "indirect"};
  const auto render = bench.render(std::move(scene), options);
  const auto values = render->surfaceValues("color");
  row.judge(0, largestFrom(values, 0), tolerance);
  if (values.empty()) row.error = 1e30;  // nothing was seen: no case
  if (row.error > tolerance)
    row.note = render->describeWorst("color", 0) + "; direct at most " + printNumber(largestFrom(render->surfaceValues("direct"), 0)) +
               ", indirect " + printNumber(largestFrom(render->surfaceValues("indirect"), 0));
}

void addStiffCases(Cases& cases) {
  for (const double albedo : {0.0, 0.5, 0.9, 0.99, 0.999}) {
    cases.push_back({.group = "stiff",
                     .name = "furnace, albedo " + printNumber(albedo),
                     .answer = "E_indirect = albedo in every pixel of a closed box that emits (1 - albedo)/pi",
                     .run = [albedo](Bench& bench, Row& row) { runFurnace(bench, row, albedo); },
                     .fast = albedo == 0.9});
  }
  cases.push_back({.group = "stiff",
                   .name = "white plates 0.01 voxels apart",
                   .answer = "between them E = pi L_e/(1 - albedo^2) on one, albedo times it on the other",
                   .run = runPlates,
                   .fast = true});
  cases.push_back({.group = "stiff",
                   .name = "white plates 0.01 voxels apart, lit from above",
                   .answer = "the underside is black",
                   .run = runPlatesLitFromOutside});
  cases.push_back({.group = "stiff",
                   .name = "corridor of 20 bounces",
                   .answer = "mean E at the far end of 20 x 1 x 1 m as path traced",
                   .run = [](Bench& bench, Row& row) {
                     RenderOptions options = coarse(128);
                     options.settings.push_back({"path_trace.spp", "256"});
                     options.settings.push_back({"gather_pixels.rays", "64"});
                     runAgainstPathTracer(bench, row, makeCorridor(), options, "1024", 0.1);
                     row.bound = 0.5;
                     row.why = "a third of the light comes from a thousandth of the hemisphere, which few rays meet";
                   }});
  cases.push_back({.group = "stiff",
                   .name = "rooms joined by a pinhole",
                   .answer = "mean E in the dark room as path traced, through a door of 0.05 m",
                   .run = [](Bench& bench, Row& row) {
                     RenderOptions options = coarse(64);
                     options.settings.push_back({"path_trace.spp", "512"});
                     runAgainstPathTracer(bench, row, scene::makeBuiltin("two_rooms", {{"door", "0.05"}}), options, "2048", 0.1);
                     row.bound = 1.0;
                     row.why = "an opening narrower than a voxel is walled up or as wide as a voxel";
                   }});
  cases.push_back(
      {.group = "stiff", .name = "rooms without a door", .answer = "the other room is black", .run = [](Bench& bench, Row& row) {
         expectBlack(bench, row, scene::makeBuiltin("two_rooms", {{"door", "0"}}), coarse(48));
         row.bound = 0.005;
         row.why = "shadow maps of 128 texels a side: at a wall's edge rays between two texels slip past it";
       }});
}

}  // namespace radivox::stability
