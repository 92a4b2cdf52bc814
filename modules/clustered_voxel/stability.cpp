#include "modules/clustered_voxel/stability.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "engine/stability/bench.h"
#include "engine/text.h"
#include "shaders/shared/voxel.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::clustered_voxel {

namespace {

using stability::Bench;
using stability::RenderOptions;
using stability::Row;

constexpr const char* kMethod = "clustered_voxel";

RenderOptions faceOptions(uint32_t resolution) {
  RenderOptions options;
  options.settings = {
      {"voxelize.resolution", std::to_string(resolution)}, {"visibility.rays", "64"}, {"gather.lazy", "off"}, {"bounce.residual", "1e-7"}};
  options.outputs = {"gather.irradiance", "bounce.face_radiosity", "surface.faces", "index.voxels", "voxelize.grid"};
  options.lights.pointShadowResolution = 512;
  return options;
}

/// Voxel faces of a closed convex room that look into it, with what they gather and send.
struct InnerFaces {
  std::vector<float> irradiance;  ///< red of E_indirect, as gathered
  double absorbed = 0;            ///< Σ area (1 − ρ) E, W: what stays in the walls of all that was reflected or received
  double h = 0;
};

InnerFaces listInnerFaces(stability::Render& render) {
  const size_t count = render.count("faces");
  const auto grid = render.buffer<shared::Grid>("voxelize.grid", 1)[0];
  const auto faces = render.buffer<shared::Face>("surface.faces", count);
  const auto voxels = render.buffer<uint32_t>("index.voxels", render.count("voxels"));
  const auto gathered = render.buffer<glm::vec4>("gather.irradiance", count);
  const auto radiosity = render.buffer<glm::vec3>("bounce.face_radiosity", count);
  const glm::vec3 middle = glm::vec3(grid.size) * 0.5f;
  InnerFaces inner;
  inner.h = double{grid.h};
  for (size_t s = 0; s < count; ++s) {
    const glm::vec3 at = glm::vec3(shared::unpackVoxel(voxels[faces[s].key >> 3])) + shared::decodePosition(faces[s].position);
    if (glm::dot(shared::faceVector(faces[s].key & 7u), middle - at) < 0.f) continue;
    inner.irradiance.push_back(gathered[s].x);
    const double albedo = double{shared::decodeAlbedo(faces[s].albedo).x};
    if (albedo > 0) inner.absorbed += double{faces[s].area} * inner.h * inner.h * (1.0 - albedo) / albedo * double{radiosity[s].x};
  }
  return inner;
}

/// B = 1 at every face of a box that emits (1 − ρ)/π: E_indirect = ρ, of any face, from any number of clusters.
void runFurnaceFaces(Bench& bench, Row& row, double albedo) {
  const auto render = bench.render(scene::makeBuiltin("furnace", {{"albedo", printNumber(albedo)}}), faceOptions(12));
  const InnerFaces inner = listInnerFaces(*render);
  row.judge(albedo, stability::meanOf(inner.irradiance), 2e-4);
  row.error = inner.irradiance.empty() ? 1e30 : stability::largestFrom(inner.irradiance, albedo);
}

/// What the lamp sends, 4πI, is what the walls keep.
void runEnergyBalance(Bench& bench, Row& row, double albedo, bool byArea) {
  RenderOptions options = faceOptions(16);
  if (byArea) options.settings.push_back({"visibility.weights", "area"});
  const auto render = bench.render(scene::makeBuiltin("box", {{"albedo", printNumber(albedo)}}), options);
  const double sent = 4.0 * glm::pi<double>();
  // 1 W/sr. Texels count the lamp's flux to 2e-3; solid angles that are not covered would show at once.
  row.judge(sent, listInnerFaces(*render).absorbed, 5e-3, sent);
  if (byArea) return;
  row.bound = 0.04;
  row.why =
      "clusters are means by how much of a face others see from beyond two voxels, which leaves out what is buried: faces along a room's "
      "edges, which the lamp lights least, count for less";
}

/// Σ of the pieces in all voxels against the mesh, in fixed point.
void runArea(Bench& bench, Row& row, uint32_t resolution, scene::Scene scene) {
  RenderOptions options;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}, {"visibility.rays", "8"}};
  const double area = scene.traits().surfaceArea;
  const auto render = bench.render(std::move(scene), options);
  row.judge(area, render->figure("surface", "total_area").value_or(0), 1e-4, area);
}

/// The paper's sum of cos cos' / (π d²) over visible clusters, where the counted form factors are exact.
void runDifferential(Bench& bench, Row& row, uint32_t resolution, double albedo) {
  RenderOptions options = faceOptions(resolution);
  options.settings.push_back({"gather.estimator", "differential"});
  const auto render = bench.render(scene::makeBuiltin("furnace", {{"albedo", printNumber(albedo)}}), options);
  const InnerFaces inner = listInnerFaces(*render);
  row.shown = true;
  row.judge(albedo, stability::meanOf(inner.irradiance), 2e-4);
  row.error = stability::largestFrom(inner.irradiance, albedo);
  row.note =
      "largest E of a face " + printNumber(row.error + albedo) + ": corners, where d goes to 0, diverge with 1/d^2 and nothing normalises";
}

}  // namespace

void addStabilityCases(plugin::Registry& registry) {
  for (const double albedo : {0.0, 0.5, 0.9, 0.99, 0.999}) {
    registry.addStabilityCase({.group = "faces",
                               .name = "furnace, albedo " + printNumber(albedo),
                               .answer = "E_indirect = albedo at every voxel face inside",
                               .run = [albedo](Bench& bench, Row& row) { runFurnaceFaces(bench, row, albedo); },
                               .method = kMethod,
                               .fast = albedo == 0.999});
  }
  for (const double albedo : {0.5, 0.9, 0.99, 0.999}) {
    for (const bool byArea : {true, false}) {
      registry.addStabilityCase({.group = "faces",
                                 .name = "energy balance, albedo " + printNumber(albedo) + (byArea ? ", faces by area" : ""),
                                 .answer = "the walls of a closed box absorb what the lamp sends, 4 pi W",
                                 .run = [albedo, byArea](Bench& bench, Row& row) { runEnergyBalance(bench, row, albedo, byArea); },
                                 .method = kMethod,
                                 .fast = albedo == 0.99});
    }
  }
  for (const uint32_t resolution : {8u, 64u, 256u}) {
    registry.addStabilityCase(
        {.group = "faces",
         .name = "area at N = " + std::to_string(resolution),
         .answer = "the areas of all pieces add up to the mesh's",
         .run = [resolution](Bench& bench, Row& row) { runArea(bench, row, resolution, scene::makeBuiltin("sphere")); },
         .method = kMethod});
  }
  registry.addStabilityCase({.group = "faces",
                             .name = "area of 1e5 triangles in 8 voxels a side",
                             .answer = "the areas of all pieces add up to the mesh's",
                             .run =
                                 [](Bench& bench, Row& row) {
                                   runArea(bench, row, 8, scene::makeBuiltin("plane", {{"subdivisions", "224"}}));
                                 },
                             .method = kMethod});
  for (const uint32_t resolution : {8u, 16u, 32u}) {
    registry.addStabilityCase({.group = "paper",
                               .name = "differential estimator in a furnace of albedo 0.9, N = " + std::to_string(resolution),
                               .answer = "E_indirect = albedo at every voxel face inside",
                               .run = [resolution](Bench& bench, Row& row) { runDifferential(bench, row, resolution, 0.9); },
                               .method = kMethod,
                               .fast = resolution == 8});
  }
}

}  // namespace radivox::clustered_voxel
