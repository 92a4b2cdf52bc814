// The G-buffer against a ray caster that knows only the definitions.
#include <gtest/gtest.h>

#include <random>

#include "tests/frame/frame_fixture.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/light_oracle.h"

namespace radivox {
namespace {

using frame_test::FrameOptions;
using frame_test::FrameRun;
using frame_test::SceneBuilder;
using oracles::LightOracle;

class GBufferTest : public oracles::GpuTest {};

FrameOptions gbufferOnly(uint32_t width, uint32_t height) {
  FrameOptions options;
  options.width = width;
  options.height = height;
  options.outputs = {"gbuffer.position", "gbuffer.normal", "gbuffer.albedo", "gbuffer.emission", "gbuffer.triangle"};
  return options;
}

/// Triangles of all sizes about the origin, half of them with bent vertex normals, some emissive.
SceneBuilder makeSoup(uint32_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.f, 1.f);
  const auto vector = [&] {
    const float x = unit(random), y = unit(random), z = unit(random);
    return glm::vec3(x, y, z);
  };
  SceneBuilder b;
  b.addMaterial({0.8f, 0.1f, 0.2f});
  b.addMaterial({0.3f, 0.9f, 0.4f}, {5.f, 4.f, 3.f});
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 centre = 2.f * vector();
    const float size = 0.05f + 0.8f * std::abs(unit(random));
    b.addTriangle(centre + size * vector(), centre + size * vector(), centre + size * vector(), i % 3);
    if (i % 2 == 0)
      for (size_t k = 0; k < 3; ++k) {
        glm::vec3& normal = b.scene.vertices[3 * i + k].normal;
        normal = glm::normalize(normal + 0.3f * vector());
      }
  }
  return b;
}

void compareWithRays(gpu::Device& device, const SceneBuilder& b, uint32_t width, uint32_t height) {
  FrameRun run(device, b.scene, gbufferOnly(width, height));
  const auto position = run.pixels("gbuffer.position"), normal = run.pixels("gbuffer.normal"), albedo = run.pixels("gbuffer.albedo"),
             emission = run.pixels("gbuffer.emission");
  const auto triangle = run.words("gbuffer.triangle");
  const LightOracle rays(b.scene);
  const scene::CameraDescription& camera = b.scene.cameras.front();
  const glm::dvec3 forward = glm::dquat(camera.orientation) * glm::dvec3(0, 0, -1);
  size_t surfaces = 0, compared = 0;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = size_t{y} * width + x;
      // A pixel whose centre is within a hundredth of a pixel of a silhouette may fall on either side of it.
      std::optional<oracles::RayHit> hit;
      glm::dvec3 origin, direction;
      bool certain = true;
      for (int k = 0; k < 5; ++k) {
        const double dx = k == 1 ? 0.01 : k == 2 ? -0.01 : 0, dy = k == 3 ? 0.01 : k == 4 ? -0.01 : 0;
        LightOracle::cameraRay(camera, width, height, x + 0.5 + dx, y + 0.5 + dy, origin, direction);
        const auto other = rays.castRay(origin, direction);
        if (k == 0) hit = other;
        certain = certain && other.has_value() == hit.has_value() && (!hit || other->triangle == hit->triangle);
      }
      if (!certain) continue;
      ++compared;
      LightOracle::cameraRay(camera, width, height, x + 0.5, y + 0.5, origin, direction);
      ASSERT_EQ(triangle[i], hit ? hit->triangle + 1 : 0u) << x << ", " << y;
      if (!hit) {
        for (const auto* image : {&position, &normal, &albedo, &emission}) EXPECT_EQ((*image)[i], glm::vec4(0.f));
        continue;
      }
      ++surfaces;
      const glm::dvec3 expected = origin + hit->t * direction;
      const double footprint = 1e-5 + 1e-5 * glm::length(expected);
      const double slope = std::abs(glm::dot(rays.normal(hit->triangle), direction));
      EXPECT_LT(glm::length(glm::dvec3(position[i]) - expected), footprint / std::max(slope, 1e-3)) << x << ", " << y;
      // On the plane it is far nearer: shadow tests stand on that.
      EXPECT_LT(std::abs(glm::dot(glm::dvec3(position[i]) - rays.corner(hit->triangle, 0), rays.normal(hit->triangle))), 2e-6);
      EXPECT_NEAR(position[i].w, glm::dot(expected - glm::dvec3(camera.position), forward), footprint / std::max(slope, 1e-3));

      glm::dvec3 shading(0);
      for (size_t k = 0; k < 3; ++k)
        shading += hit->barycentric[static_cast<int>(k)] * glm::dvec3(b.scene.vertices[b.scene.indices[3 * hit->triangle + k]].normal);
      shading = glm::normalize(shading);
      glm::dvec3 towards = rays.normal(hit->triangle);
      const bool front = glm::dot(towards, direction) < 0;
      if (!front) towards = -towards;
      if (glm::dot(shading, towards) < 0) shading = -shading;
      EXPECT_LT(glm::length(glm::dvec3(normal[i]) - shading), 1e-4 / std::max(slope, 1e-3));
      EXPECT_EQ(normal[i].w, 0.f);
      const shared::Material& material = b.scene.materials[b.scene.triangleMaterials[hit->triangle]];
      EXPECT_EQ(albedo[i], glm::vec4(material.albedo, 1.f));
      EXPECT_EQ(glm::vec3(emission[i]), front ? material.emission : glm::vec3(0.f));
    }
  }
  EXPECT_GT(compared, size_t{width} * height * 9 / 10);
  EXPECT_GT(surfaces, size_t{width} * height / 4);
}

TEST_F(GBufferTest, MatchesRayCasterInPerspective) {
  SceneBuilder b = makeSoup(150);
  b.lookAt({0.3f, 1.2f, 4.5f}, {0.f, 0.f, 0.f}, 0.7f);
  compareWithRays(device(), b, 97, 61);
}

TEST_F(GBufferTest, MatchesRayCasterInParallelView) {
  SceneBuilder b = makeSoup(150);
  b.lookParallel({4.f, 3.f, -5.f}, {0.f, 0.f, 0.f}, 2.f);
  compareWithRays(device(), b, 61, 97);
}

TEST_F(GBufferTest, CameraInsideTheScene) {
  SceneBuilder b = makeSoup(150);
  b.lookAt({0.1f, 0.f, 0.1f}, {1.f, 0.3f, -1.f}, 1.6f);
  compareWithRays(device(), b, 64, 64);
}

TEST_F(GBufferTest, SidesObeyTheFlagOnlyWhenAsked) {
  SceneBuilder b;
  const uint32_t twoSided = b.addMaterial(glm::vec3(0.2f), glm::vec3(0.f), shared::kMaterialDoubleSided);
  // Left: single-sided, seen from behind. Right: double-sided, likewise. Behind both: a single-sided wall that faces us.
  b.addQuad({0.f, -1.f, 0.f}, {-1.f, -1.f, 0.f}, {-1.f, 1.f, 0.f}, {0.f, 1.f, 0.f});
  b.addQuad({1.f, -1.f, 0.f}, {0.f, -1.f, 0.f}, {0.f, 1.f, 0.f}, {1.f, 1.f, 0.f}, twoSided);
  b.addQuad({-9.f, -9.f, -1.f}, {9.f, -9.f, -1.f}, {9.f, 9.f, -1.f}, {-9.f, 9.f, -1.f});
  b.lookParallel({0.f, 0.f, 5.f}, {0.f, 0.f, 0.f}, 0.9f);
  FrameOptions options = gbufferOnly(32, 32);
  const auto both = FrameRun(device(), b.scene, options).words("gbuffer.triangle");
  options.settings = {{"gbuffer.sides", "gltf"}};
  const auto gltf = FrameRun(device(), b.scene, options).words("gbuffer.triangle");
  for (size_t i = 0; i < both.size(); ++i) {
    const bool left = i % 32 < 16;
    EXPECT_EQ((both[i] - 1) / 2, left ? 0u : 1u);
    EXPECT_EQ((gltf[i] - 1) / 2, left ? 2u : 1u);
  }
}

TEST_F(GBufferTest, NormalFacesTheViewerWhateverTheFileSays) {
  SceneBuilder b;
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f});
  for (auto& vertex : b.scene.vertices) vertex.normal = {0.f, 0.f, -1.f};  // against the winding
  for (const float side : {1.f, -1.f}) {
    b.lookAt({0.f, 0.f, 2.f * side}, {0.f, 0.f, 0.f}, 0.5f);
    for (const glm::vec4& n : FrameRun(device(), b.scene, gbufferOnly(8, 8)).pixels("gbuffer.normal"))
      EXPECT_EQ(n, glm::vec4(0.f, 0.f, side, 0.f));
  }
}

/// Nearest-filtered texture of 4 × 4 texels: red index in steps of 16, alpha 255 on the white fields of a chessboard.
scene::TextureImage makeBoard() {
  scene::TextureImage board;
  board.name = "board";
  board.width = board.height = 4;
  board.nearest = true;
  board.srgb = false;
  for (uint32_t i = 0; i < 16; ++i) {
    const bool white = (i % 4 + i / 4) % 2 == 0;
    board.rgba.insert(board.rgba.end(), {static_cast<uint8_t>(16 * i), 255, 51, static_cast<uint8_t>(white ? 255 : 0)});
  }
  return board;
}

TEST_F(GBufferTest, TexturesColourAndMask) {
  SceneBuilder b;
  b.scene.textures.push_back(makeBoard());
  shared::Material& material = b.scene.materials.front();
  material.albedo = {0.8f, 0.4f, 0.9f};
  material.baseTexture = 0;
  material.emission = glm::vec3(2.f);
  material.emissiveTexture = 0;
  material.flags = shared::kMaterialEmissive;
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f});
  b.lookParallel({0.f, 0.f, 2.f}, {0.f, 0.f, 0.f}, 1.f);
  const auto check = [&](bool masked) {
    FrameRun run(device(), b.scene, gbufferOnly(32, 32));
    const auto albedo = run.pixels("gbuffer.albedo"), emission = run.pixels("gbuffer.emission");
    for (uint32_t y = 0; y < 32; ++y) {
      for (uint32_t x = 0; x < 32; ++x) {
        const uint32_t field = x / 8 + 4 * (y / 8);
        const bool white = (x / 8 + y / 8) % 2 == 0;
        const float red = static_cast<float>(16 * field) / 255.f;
        const bool there = white || !masked;
        const glm::vec4 expected = there ? glm::vec4(0.8f * red, 0.4f, 0.18f, 1.f) : glm::vec4(0.f);
        EXPECT_LT(glm::length(albedo[y * 32 + x] - expected), 1e-5f) << x << ", " << y;
        const glm::vec3 glow = there ? glm::vec3(2.f * red, 2.f, 0.4f) : glm::vec3(0.f);
        EXPECT_LT(glm::length(glm::vec3(emission[y * 32 + x]) - glow), 1e-5f) << x << ", " << y;
      }
    }
  };
  check(false);
  b.scene.materials.front().flags |= shared::kMaterialAlphaMask;
  check(true);
  // The factor's alpha multiplies: below the cutoff nothing is left.
  b.scene.materials.front().alpha = 0.4f;
  for (const uint32_t id : FrameRun(device(), b.scene, gbufferOnly(32, 32)).words("gbuffer.triangle")) EXPECT_EQ(id, 0u);
}

TEST_F(GBufferTest, AlbedoStaysBelowOne) {
  SceneBuilder b;
  b.scene.textures.push_back(makeBoard());
  b.scene.materials.front().albedo = glm::vec3(0.999f);
  b.scene.materials.front().baseTexture = 0;
  b.addQuad({-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f});
  b.lookParallel({0.f, 0.f, 2.f}, {0.f, 0.f, 0.f}, 1.f);
  for (const glm::vec4& albedo : FrameRun(device(), b.scene, gbufferOnly(8, 8)).pixels("gbuffer.albedo")) EXPECT_LE(albedo.y, 0.999f);
}

}  // namespace
}  // namespace radivox
