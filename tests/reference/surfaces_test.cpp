// Surfaces that are not walls: aslant, curved, thin, full of holes. Indirect light on each against the path tracer, beside that on a flat wall of the
// same picture: voxels must show as neither steps nor rings nor shadows of a surface on itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "engine/scene/builtin_mesh.h"
#include "modules/reference/path_tracer.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

constexpr uint32_t kWidth = 384, kHeight = 96;
constexpr double kLength = 10, kRoomHeight = 3, kBack = -2, kFront = 4;  // m

enum Kind : uint32_t { kWalls, kBackWall, kSphere, kStairs, kRamp, kCurtain, kLeaves, kKindCount };
constexpr std::array<const char*, kKindCount> kNames{"walls", "flat wall", "sphere", "staircase", "ramp of 30°", "curtain", "leaves"};

struct Leaf {
  std::array<glm::dvec3, 4> corners;
};

void addRoom(scene::MeshBuilder& mesh, uint32_t walls, uint32_t back) {
  const auto at = [](int x, int y, int z) { return glm::dvec3((x - 0.5) * kLength, y * kRoomHeight, z == 0 ? kBack : kFront); };
  mesh.addQuad(at(0, 0, 0), at(0, 0, 1), at(1, 0, 1), at(1, 0, 0), walls);
  mesh.addQuad(at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1), walls);
  mesh.addQuad(at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1), walls);
  mesh.addQuad(at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0), walls);
  mesh.addQuad(at(0, 0, 1), at(0, 1, 1), at(1, 1, 1), at(1, 0, 1), walls);
  mesh.addQuad(at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0), back);
}

/// Twigs' worth of quads, each turned another way.
std::vector<Leaf> addLeaves(scene::MeshBuilder& mesh, uint32_t material) {
  std::vector<Leaf> leaves;
  for (int i = 0; i < 18; ++i) {
    const double turn = 2.4 * i, tilt = 0.5 + 0.4 * std::sin(1.7 * i);
    const glm::dvec3 centre(3.6 + 0.35 * (i % 3), 0.5 + 0.33 * (i / 3), -0.7 + 0.3 * std::sin(2.1 * i));
    const glm::dvec3 u = 0.22 * glm::dvec3(std::cos(turn), 0, std::sin(turn));
    const glm::dvec3 v = 0.22 * glm::dvec3(-std::sin(turn) * std::cos(tilt), std::sin(tilt), std::cos(turn) * std::cos(tilt));
    leaves.push_back({{centre - u - v, centre + u - v, centre + u + v, centre - u + v}});
    const auto& c = leaves.back().corners;
    mesh.addQuad(c[0], c[1], c[2], c[3], material);
  }
  return leaves;
}

/// A third of each quad is hole.
void cutLeaves(scene::Scene& scene, uint32_t material, const std::vector<Leaf>& leaves) {
  scene::TextureImage image;
  image.name = "leaf";
  image.width = image.height = 64;
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const double u = (x + 0.5) / 32 - 1, v = (y + 0.5) / 32 - 1;
      const bool isLeaf = u * u + v * v < 0.9 && std::abs(u) > 0.06;
      image.rgba.insert(image.rgba.end(), {255, 255, 255, static_cast<uint8_t>(isLeaf ? 255 : 0)});
    }
  scene.materials[material].flags |= shared::kMaterialAlphaMask;
  scene.materials[material].baseTexture = static_cast<uint32_t>(scene.textures.size());
  scene.textures.push_back(image);
  for (size_t t = 0; t < scene.triangleCount(); ++t) {
    if (scene.triangleMaterials[t] != material) continue;
    for (size_t k = 0; k < 3; ++k) {
      shared::Vertex& vertex = scene.vertices[scene.indices[3 * t + k]];
      for (const Leaf& leaf : leaves)
        for (size_t c = 0; c < 4; ++c)
          if (glm::length(glm::dvec3(vertex.position) + scene.origin - leaf.corners[c]) < 1e-4)
            vertex.uvBase = glm::vec2(c == 1 || c == 2 ? 1 : 0, c >= 2 ? 1 : 0);
    }
  }
}

scene::Scene makeRoom(std::array<uint32_t, kKindCount>& materials) {
  scene::MeshBuilder mesh("surfaces");
  for (uint32_t k = 0; k < kKindCount; ++k) {
    const bool isThin = k == kCurtain || k == kLeaves;
    materials[k] = mesh.addMaterial(kNames[k], glm::vec3(0.6f), glm::vec3(0.f), isThin ? shared::kMaterialDoubleSided : 0u);
  }
  addRoom(mesh, materials[kWalls], materials[kBackWall]);
  addBall(
      mesh, {-3.9, 0.9, -0.8}, [](const glm::dvec3&) { return 0.7; }, 12, false, materials[kSphere]);
  for (int i = 0; i < 6; ++i) {
    const double height = 0.24 * (i + 1), depth = 0.24;
    mesh.addBlock({-2.05, height / 2, 0.2 - depth * i}, {1.4, height, depth}, 0, materials[kStairs]);
  }
  const double rise = 1.6 * std::tan(std::numbers::pi / 6);
  mesh.addQuad({-0.7, 0, 0.3}, {0.9, 0, 0.3}, {0.9, rise, -1.3}, {-0.7, rise, -1.3}, materials[kRamp]);
  mesh.addSurface([](double u, double v) { return glm::dvec3(1.35 + 1.6 * u, 0.2 + 2.3 * v, -0.8 + 0.12 * std::sin(28 * u)); }, 96, 8,
                  materials[kCurtain], true);
  const std::vector<Leaf> leaves = addLeaves(mesh, materials[kLeaves]);
  mesh.addPointLight({0.5, 2.6, 2.2}, glm::vec3(30.f));
  mesh.addCamera("front", {0, 1.5, 3.9}, {0, 1.25, 0}, 0.5);
  scene::Scene scene = mesh.finish(1, glm::dvec3(0));
  cutLeaves(scene, materials[kLeaves], leaves);
  return scene;
}

/// Of the pixels of one kind that have no other kind beside them.
struct Error {
  double squares = 0, truthSquares = 0, have = 0, truth = 0;
  size_t pixels = 0;
  double relative() const { return std::sqrt(std::max(squares, 0.0) / truthSquares); }
  double bias() const { return have / truth; }
};

/// The kind of what each pixel shows.
std::vector<uint32_t> kindsOf(oracles::Pipeline& p, const std::array<uint32_t, kKindCount>& materials) {
  const auto raw = gpu::download(oracles::sharedDevice(), *p.executor->findImage("gbuffer.triangle"));
  std::vector<uint32_t> kinds(size_t{kWidth} * kHeight);
  std::memcpy(kinds.data(), raw.data(), kinds.size() * 4);
  for (uint32_t& kind : kinds) {
    const uint32_t material = p.scene.triangleMaterials[kind - 1];
    kind = static_cast<uint32_t>(std::find(materials.begin(), materials.end(), material) - materials.begin());
  }
  return kinds;
}

std::array<Error, kKindCount> compare(const image::Image& have, const reference::Estimate& truth, const std::vector<uint32_t>& kinds) {
  std::array<Error, kKindCount> errors{};
  for (uint32_t y = 1; y + 1 < kHeight; ++y)
    for (uint32_t x = 1; x + 1 < kWidth; ++x) {
      const size_t i = size_t{y} * kWidth + x;
      bool isAlone = true;
      for (const size_t row : {i - kWidth, i, i + kWidth})
        for (const size_t j : {row - 1, row, row + 1}) isAlone = isAlone && kinds[j] == kinds[i];
      if (!isAlone) continue;
      Error& error = errors[kinds[i]];
      const double e = have.data[3 * i + 1], t = truth.mean.data[3 * i + 1], noise = truth.variance.data[3 * i + 1];
      error.squares += (e - t) * (e - t) - noise;
      error.truthSquares += t * t - noise;
      error.have += e;
      error.truth += t;
      ++error.pixels;
    }
  return errors;
}

class Surfaces : public oracles::GpuTest {};

TEST_F(Surfaces, SlowAslantCurvedAndThinOnesErrNoMoreThanFlatOnes) {
  std::array<uint32_t, kKindCount> materials{};
  const scene::Scene room = makeRoom(materials);
  const reference::PathTracer tracer(room);
  const reference::Images truth = tracer.render(room.cameras.at(0), {.width = kWidth, .height = kHeight, .spp = 128});
  for (const char* resolution : {"64", "128"}) {
    oracles::PipelineOptions options;
    options.graph = "clustered_voxel_pixels";
    options.width = kWidth;
    options.height = kHeight;
    options.outputs = {"gather_pixels.irradiance", "gbuffer.triangle"};
    options.settings = {{"voxelize.resolution", resolution}};
    oracles::Pipeline p(oracles::sharedDevice(), room, options);
    p.run();
    const image::Image have = p.picture("gather_pixels.irradiance");
    const auto errors = compare(have, truth.irradianceIndirect, kindsOf(p, materials));
    for (uint32_t k = 0; k < kKindCount; ++k)
      std::printf("N = %s, %-11s: error %.3f of its light, bias %.3f (%zu pixels)\n", resolution, kNames[k], errors[k].relative(),
                  errors[k].bias(), errors[k].pixels);
    for (const Kind kind : {kSphere, kStairs, kRamp, kCurtain, kLeaves}) {
      ASSERT_GT(errors[kind].pixels, 150u) << kNames[kind];
      EXPECT_LT(errors[kind].relative(), 1.5 * errors[kBackWall].relative()) << kNames[kind] << ", N = " << resolution;
    }
  }
}

}  // namespace
}  // namespace radivox
