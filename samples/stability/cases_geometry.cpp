// Extreme triangles, voxels and materials.
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "samples/stability/cases.h"
#include "samples/stability/scenes.h"

namespace radivox::stability {

namespace {

using glm::dvec3;

/// An empty room, lit, whose floor is as given.
scene::Scene roomWithFloor(const std::function<void(SceneMaker&, uint32_t)>& addFloor) {
  SceneMaker make("room with a floor");
  const uint32_t wall = make.addMaterial(0.6f);
  // All sides but the floor.
  make.addPatch({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 1, 1, wall);
  make.addPatch({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, 1, 1, wall);
  make.addPatch({-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, 1, 1, wall);
  make.addPatch({-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, 1, 1, wall);
  make.addPatch({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, 1, 1, wall);
  addFloor(make, wall);
  make.addLamp({0.3, 0.6, 0.2}, 1.f);
  make.lookFrom({0.5, 0.2, 0.9}, {-0.3, -0.4, -0.8}, 1.2f);
  return make.take();
}

scene::Scene plainFloor() {
  return roomWithFloor([](SceneMaker& make, uint32_t wall) { make.addPatch({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 1, 1, wall); });
}

/// Strips 2 m long and 2 µm wide, 200 of them in each of ten bands of the floor (a million would be all of it).
scene::Scene needleFloor() {
  return roomWithFloor([](SceneMaker& make, uint32_t wall) {
    constexpr double kWidth = 2e-6;
    constexpr uint32_t kNeedles = 200, kBands = 10;
    double from = -1;
    for (uint32_t band = 0; band < kBands; ++band) {
      const double needlesAt = -1.0 + (band + 0.5) * 2.0 / kBands, end = needlesAt + kNeedles * kWidth;
      make.addPatch({from, -1, -1}, {0, 0, 2}, {needlesAt - from, 0, 0}, 1, 1, wall);
      make.addPatch({needlesAt, -1, -1}, {0, 0, 2}, {kNeedles * kWidth, 0, 0}, 1, kNeedles, wall);
      from = end;
    }
    make.addPatch({from, -1, -1}, {0, 0, 2}, {1 - from, 0, 0}, 1, 1, wall);
  });
}

/// A fan of needles that share one corner: the whole floor.
scene::Scene fanFloor() {
  return roomWithFloor([](SceneMaker& make, uint32_t wall) {
    constexpr uint32_t kParts = 20000;
    const auto rim = [](uint32_t i) {
      const double s = 2.0 * i / kParts;
      return s < 1 ? dvec3(-1 + 2 * s, -1, 1) : dvec3(1, -1, 1 - 2 * (s - 1));
    };
    for (uint32_t i = 0; i < kParts; ++i) make.addTriangle({-1, -1, -1}, rim(i), rim(i + 1), wall);
  });
}

scene::Scene fragmentedFloor(uint32_t parts) {
  return roomWithFloor([parts](SceneMaker& make, uint32_t wall) {
    make.addPatch({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 1, 1, wall);
    // A shelf within one voxel.
    make.addPatch({0.4, -0.5, -0.4}, {0, 0, 0.05}, {0.05, 0, 0}, parts, parts, wall);
  });
}

scene::Scene withSpeck(const scene::Scene& room, uint32_t count, double side) {
  scene::Scene scene = room;
  for (uint32_t i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count;
    const glm::vec3 at(static_cast<float>(-0.9 + 1.8 * t), static_cast<float>(-0.2 + 0.3 * glm::fract(t * 97)), 0.3f);
    for (int k = 0; k < 3; ++k) {
      shared::Vertex vertex{};
      vertex.position = at + glm::vec3(k == 1 ? static_cast<float>(side) : 0.f, k == 2 ? static_cast<float>(side) : 0.f, 0.f);
      vertex.normal = {0, 0, 1};
      scene.indices.push_back(static_cast<uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(vertex);
    }
    scene.triangleMaterials.push_back(0);
  }
  return scene;
}

/// The same surface again in other triangles: each cut in two.
scene::Scene doubled(const scene::Scene& room) {
  scene::Scene scene = room;
  for (size_t t = 0; t < room.triangleMaterials.size(); ++t) {
    const auto corner = [&](size_t k) { return room.indices[t * 3 + k]; };
    shared::Vertex middle = room.vertices[corner(0)];
    middle.position = 0.5f * (room.vertices[corner(0)].position + room.vertices[corner(1)].position);
    const auto between = static_cast<uint32_t>(scene.vertices.size());
    scene.vertices.push_back(middle);
    for (const uint32_t index : {corner(0), between, corner(2), between, corner(1), corner(2)}) scene.indices.push_back(index);
    scene.triangleMaterials.insert(scene.triangleMaterials.end(), 2, room.triangleMaterials[t]);
  }
  return scene;
}

/// The same triangles again.
scene::Scene repeated() {
  scene::Scene scene = litRoom();
  const std::vector<uint32_t> indices = scene.indices, materials = scene.triangleMaterials;
  scene.indices.insert(scene.indices.end(), indices.begin(), indices.end());
  scene.triangleMaterials.insert(scene.triangleMaterials.end(), materials.begin(), materials.end());
  return scene;
}

/// Two motes 400 m apart stretch the bounds: the room of 2 m lies in one voxel of a grid of 32.
scene::Scene inOneVoxel() {
  scene::Scene scene = litRoom();
  for (const float end : {-200.f, 200.f}) {
    for (int k = 0; k < 3; ++k) {
      shared::Vertex vertex{};
      vertex.position = glm::vec3(end + 0.3f, 0.3f, 0.3f) + glm::vec3(0.f, k == 1 ? 0.01f : 0.f, k == 2 ? 0.01f : 0.f);
      vertex.normal = {1, 0, 0};
      scene.indices.push_back(static_cast<uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(vertex);
    }
    scene.triangleMaterials.push_back(0);
  }
  return scene;
}

void runOneVoxel(Bench& bench, Row& row) {
  const auto expected = bench.render(litRoom(), coarse())->surfaceValues("irradiance_indirect");
  RenderOptions options = coarse();
  options.aovs = {"irradiance_indirect", "color"};
  const auto values = bench.render(inOneVoxel(), options)->surfaceValues("irradiance_indirect");
  const double mean = meanOf(expected);
  row.judge(mean, meanOf(values), bench.tolerance(0.1), mean);
  row.bound = 1.0;
  row.why = "the scene is one voxel: what goes on inside a voxel is not resolved, its light is lost, and none is made";
}

/// A floor of 10⁶ m under a room's lamp: no indirect light anywhere, direct light as the cosine law has it.
void runHugeTriangle(Bench& bench, Row& row) {
  SceneMaker make("huge triangle");
  const uint32_t ground = make.addMaterial(0.5f);
  make.addTriangle({-1e6, 0, 1e6}, {1e6, 0, 1e6}, {0, 0, -1e6}, ground);
  make.addSun({0.3, -1, 0.2}, 10.f);
  make.lookFrom({0, 2, 0}, {0.5, 0, -1}, 0.8f);
  RenderOptions options = coarse();
  options.aovs = {"irradiance_indirect", "irradiance_direct"};
  const auto render = bench.render(make.take(), options);
  const double cosine = 1.0 / glm::length(dvec3(0.3, -1, 0.2));
  const auto direct = render->surfaceValues("irradiance_direct");
  row.judge(10.0 * cosine, meanOf(direct), 1e-3, 10.0);
  row.error = std::max(row.error, largestFrom(direct, 10.0 * cosine) / 10.0);
  const double bounced = largestFrom(render->surfaceValues("irradiance_indirect"), 0);
  if (bounced > 1e-4) row.error = bounced;
  row.note = "largest E_indirect " + std::to_string(bounced);
}

/// The same walls on the borders of voxels and between them: a box of 31 voxels (N = 32) or 30.
void runOnBorders(Bench& bench, Row& row) {
  double worst = 0, mean = 0;
  for (const uint32_t resolution : {17u, 32u, 33u}) {
    RenderOptions options = coarse(resolution);
    options.settings.push_back({"bounce.residual", "1e-7"});
    const auto values = bench.render(scene::makeBuiltin("furnace"), options)->surfaceValues("irradiance_indirect");
    mean = meanOf(values);
    worst = std::max(worst, bench.isNoisy() ? std::abs(mean - 0.5) : largestFrom(values, 0.5));
  }
  row.judge(0.5, mean, bench.tolerance(2e-4));
  row.error = worst;
}

scene::Scene withNormals(const std::function<glm::vec3(const glm::vec3&)>& change) {
  scene::Scene scene = litRoom();
  for (shared::Vertex& vertex : scene.vertices) vertex.normal = change(vertex.normal);
  return scene;
}

scene::Scene withAlbedo(float albedo) {
  scene::Scene scene = litRoom();
  for (shared::Material& material : scene.materials) material.albedo = glm::vec3(albedo);
  return scene;
}

void addNormalCases(Cases& cases) {
  cases.push_back({.group = "extreme",
                   .name = "all normals zero",
                   .answer = "the picture with the triangles' own normals",
                   .run =
                       [](Bench& bench, Row& row) {
                         RenderOptions options = coarse();
                         options.aovs = {"color", "irradiance_indirect"};
                         compareScenes(bench, row, litRoom(), withNormals([](const glm::vec3&) { return glm::vec3(0.f); }), options,
                                       bench.tolerance(1e-4), "color");
                       },
                   .fast = true});
  cases.push_back({.group = "extreme",
                   .name = "all normals opposed",
                   .answer = "the picture with the triangles' own normals: shading normals turn to the viewer's side",
                   .run = [](Bench& bench, Row& row) {
                     RenderOptions options = coarse();
                     options.aovs = {"color", "irradiance_indirect"};
                     compareScenes(bench, row, litRoom(), withNormals([](const glm::vec3& n) { return -n; }), options,
                                   bench.tolerance(1e-4), "color");
                   }});
}

void addTriangleCases(Cases& cases) {
  const auto compare = [](scene::Scene (*reference)(), std::function<scene::Scene()> test, double tolerance) {
    return [=](Bench& bench, Row& row) { compareScenes(bench, row, reference(), test(), coarse(), bench.tolerance(tolerance)); };
  };
  cases.push_back({.group = "extreme",
                   .name = "needles of 1e6 to 1",
                   .answer = "the picture of a floor of two triangles",
                   .run = compare(plainFloor, needleFloor, 2e-3)});
  cases.push_back({.group = "extreme",
                   .name = "a fan of 20000 needles",
                   .answer = "the picture of a floor of two triangles",
                   .run = compare(plainFloor, fanFloor, 2e-3)});
  cases.push_back(
      {.group = "extreme", .name = "1000 triangles of 1e-12 m^2", .answer = "the picture without them", .run = [](Bench& bench, Row& row) {
         compareScenes(bench, row, litRoom(), withSpeck(litRoom(), 1000, 1.4e-6), coarse(), bench.tolerance(1e-2));
         row.bound = 0.03;
         row.why = "where surface ends is known to a sixteenth of a voxel: rays are stopped by specks as if they were that large";
       }});
  const std::pair<const char*, scene::Scene (*)()> copies[] = {{"every triangle twice", repeated},
                                                               {"every surface twice, cut differently", [] { return doubled(litRoom()); }}};
  for (const auto& [name, make] : copies) {
    cases.push_back(
        {.group = "extreme", .name = name, .answer = "the picture with each once", .run = [make = make](Bench& bench, Row& row) {
           compareScenes(bench, row, litRoom(), make(), coarse(), bench.tolerance(1e-2));
           row.bound = 0.03;
           row.why = "voxels that surface fills in part only count both sheets: their light is halved";
         }});
  }
  cases.push_back({.group = "extreme",
                   .name = "a voxel of 1e5 triangles",
                   .answer = "the picture with two of the same area there",
                   .run = compare([] { return fragmentedFloor(1); }, [] { return fragmentedFloor(224); }, 1e-2),
                   .fast = true});
}

}  // namespace

void addGeometryCases(Cases& cases) {
  addTriangleCases(cases);
  cases.push_back({.group = "extreme", .name = "all triangles in one voxel", .answer = "the picture of a finer grid", .run = runOneVoxel});
  cases.push_back({.group = "extreme",
                   .name = "one triangle of 1e6 m",
                   .answer = "E = 10 cos(theta) in the sun, and nothing to bounce",
                   .run = runHugeTriangle,
                   .fast = true});
  cases.push_back({.group = "extreme",
                   .name = "walls on and between voxel borders",
                   .answer = "a furnace of albedo 0.5 at N = 17, 32 and 33",
                   .run = runOnBorders});
  addNormalCases(cases);
  cases.push_back({.group = "extreme", .name = "albedo 0", .answer = "no indirect light", .run = [](Bench& bench, Row& row) {
                     const auto values = bench.render(withAlbedo(0.f), coarse())->surfaceValues("irradiance_indirect");
                     row.judge(0, largestFrom(values, 0), 0);
                   }});
  cases.push_back(
      {.group = "extreme",
       .name = "albedo 1",
       .answer = "the picture of albedo 0.999, to which it is clamped",
       .run = [](Bench& bench,
                 Row& row) { compareScenes(bench, row, withAlbedo(0.999f), withAlbedo(1.f), coarse(16), bench.tolerance(1e-4)); },
       .fast = true});
}

}  // namespace radivox::stability
