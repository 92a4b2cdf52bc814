// Every kind of light, surfaces with holes and sides, textures: against brute force and definitions.
#include <numbers>
#include <random>

#include "engine/scene/texture.h"
#include "tests/oracles/form_factors.h"
#include "tests/oracles/light_oracle.h"
#include "tests/reference/reference_fixture.h"

namespace radivox::reference_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Points on the scene's surfaces, clear of edges, with both normals.
struct SurfacePoint {
  glm::dvec3 p, n;
};
std::vector<SurfacePoint> pickPoints(const scene::Scene& scene, const oracles::LightOracle& oracle, uint32_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SurfacePoint> points;
  while (points.size() < count) {
    const auto t = static_cast<uint32_t>(unit(random) * static_cast<double>(scene.triangleCount()));
    const double root = std::sqrt(unit(random)), v = unit(random);
    const double b0 = 0.02 + 0.94 * (1 - root), b1 = 0.02 + 0.94 * root * (1 - v);
    points.push_back({b0 * oracle.corner(t, 0) + b1 * oracle.corner(t, 1) + (1 - b0 - b1) * oracle.corner(t, 2), oracle.normal(t)});
  }
  return points;
}

TEST(ReferenceLights, PunctualLightsWithShadowsAsByBruteForce) {
  scene::Scene scene = scene::loadScene("builtin:cornell_point");
  scene::PunctualLight sun;
  sun.direction = glm::normalize(glm::vec3(0.3f, -0.5f, 1.f));
  sun.intensity = {1.f, 2.f, 3.f};
  scene::PunctualLight lamp = scene.lights.at(0);
  lamp.position.x += 0.5f;
  lamp.range = 4.f;
  scene::PunctualLight spot = lamp;
  spot.type = shared::kLightSpot;
  spot.range = 0.f;
  spot.position.y -= 1.f;
  spot.direction = glm::normalize(glm::vec3(-0.3f, -1.f, 0.2f));
  spot.innerConeAngle = 0.3f;
  spot.outerConeAngle = 0.7f;
  scene::Scene stairs = scene::loadScene("builtin:staircase");
  for (const auto& [light, place] : {std::pair(sun, &stairs), std::pair(lamp, &scene), std::pair(spot, &scene)}) {
    place->lights = {light};
    const oracles::LightOracle oracle(*place);
    const reference::PathTracer tracer(*place);
    const std::vector<SurfacePoint> points = pickPoints(*place, oracle, 300);
    std::vector<reference::ProbePoint> probes;
    for (const SurfacePoint& point : points) probes.push_back({glm::vec3(point.p), glm::vec3(point.n)});
    const auto values = tracer.probe(probes, {.bounces = 0, .spp = 2});
    size_t litCount = 0, wrongCount = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const glm::dvec3 exact = oracle.punctualIrradiance(points[i].p + 1e-6 * points[i].n, points[i].n, points[i].n, true);
      litCount += exact.x > 0 ? 1 : 0;
      wrongCount += glm::length(glm::dvec3(values[i].direct) - exact) > 2e-4 * (glm::length(exact) + 1e-3) ? 1 : 0;
    }
    EXPECT_LE(wrongCount, 1u) << "type " << light.type << " (a point right on a shadow's edge may differ)";
    EXPECT_GT(litCount, 10u);
    EXPECT_LT(litCount, 290u);
  }
}

TEST(ReferenceLights, ManyLightsAddUp) {
  // One of n lights is asked a sample; the mean is the sum of all. Up to 32 are weighed all, beyond only some.
  for (const int lightCount : {5, 32, 200}) {
    scene::MeshBuilder mesh("lights");
    const uint32_t grey = mesh.addMaterial("grey", glm::vec3(0.5f));
    mesh.addQuad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, grey);
    mesh.addBlock({0.5, 0.5, 0}, {0.3, 0.3, 0.3}, 0.2, grey);
    for (int i = 0; i < lightCount; ++i) {
      const float strength = i % 7 == 0 ? 5.f : 0.2f;
      mesh.addPointLight({std::sin(i * 1.7) * 3, 0.5 + i % 5, std::cos(i * 2.3) * 3}, glm::vec3(strength, 1.f, 0.5f));
    }
    const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
    const oracles::LightOracle oracle(scene);
    for (const glm::dvec3 p : {glm::dvec3(0, 0, 0), glm::dvec3(1.5, 0, 1)}) {
      const glm::dvec3 exact = oracle.punctualIrradiance(p, {0, 1, 0}, {0, 1, 0}, true);
      const reference::ProbeValue value = probe(scene, p, {0, 1, 0}, 0, 32768);
      for (glm::length_t c = 0; c < 3; ++c) {
        expectWithin(static_cast<double>(value.direct[c]), static_cast<double>(value.directError[c]), exact[c],
                     std::to_string(lightCount) + " lights, channel " + std::to_string(c));
      }
    }
  }
}

TEST(ReferenceLights, EmittersBehindBlocksAsByBruteForce) {
  const scene::Scene scene = scene::loadScene("builtin:cornell");
  const oracles::LightOracle oracle(scene);
  const reference::PathTracer tracer(scene);
  const std::vector<SurfacePoint> points = pickPoints(scene, oracle, 60);
  std::vector<reference::ProbePoint> probes;
  for (const SurfacePoint& point : points) probes.push_back({glm::vec3(point.p), glm::vec3(point.n)});
  const auto values = tracer.probe(probes, {.bounces = 0, .spp = 1024});
  double z2 = 0;
  int litCount = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    // 1024 pieces, each seen or not: known to about a percent in a penumbra, exact outside.
    const double exact = oracle.emitterIrradiance(points[i].p + 1e-5 * points[i].n, points[i].n, points[i].n, 5, true).x;
    const auto value = static_cast<double>(values[i].direct.x), error = static_cast<double>(values[i].directError.x);
    if (exact < 1e-3) {
      EXPECT_LT(value, 0.02) << i;
      continue;
    }
    ++litCount;
    EXPECT_NEAR(value, exact, 4 * error + 0.02 * exact) << i;
    z2 += std::pow((value - exact) / (error + 0.01 * exact), 2);
  }
  EXPECT_GT(litCount, 20);
  EXPECT_LT(z2 / litCount, 1.5);
}

/// One image of 2 × 2 texels, nearest: left half opaque and bright, right half cut away and dark.
scene::TextureImage halves() {
  scene::TextureImage image;
  image.width = image.height = 2;
  image.nearest = true;
  image.rgba = {255, 255, 255, 255, 0, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0};
  return image;
}

/// A sheet over [−1, 1]² at y = 1, front up (+y), whose uv goes from 0 to 1 along x and z.
scene::Scene makeSheet(uint32_t flags, const glm::vec3& emission, bool faceDown) {
  scene::MeshBuilder mesh("sheet");
  const uint32_t ground = mesh.addMaterial("ground", glm::vec3(0.f), glm::vec3(0.f), shared::kMaterialDoubleSided);
  const uint32_t sheet = mesh.addMaterial("sheet", glm::vec3(0.5f), emission, flags);
  mesh.addQuad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, ground);
  if (faceDown) {
    mesh.addQuad({-1, 1, 1}, {-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, sheet);
  } else {
    mesh.addQuad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, sheet);
  }
  scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  for (shared::Vertex& vertex : scene.vertices) {
    vertex.uvBase = glm::vec2(0.5f * (vertex.position.x + static_cast<float>(scene.origin.x)) + 0.5f, 0.5f);
    vertex.uvEmissive = vertex.uvBase;
  }
  return scene;
}

shared::Material& findMaterial(scene::Scene& scene, const std::string& name) {
  for (size_t i = 0; i < scene.materials.size(); ++i)
    if (scene.materialNames[i] == name) return scene.materials[i];
  throw std::runtime_error("no material " + name);
}

TEST(ReferenceLights, MasksCutHolesForEveryRay) {
  scene::Scene scene = makeSheet(shared::kMaterialAlphaMask, glm::vec3(0.f), false);
  scene.textures = {halves()};
  shared::Material& sheet = findMaterial(scene, "sheet");
  sheet.baseTexture = 0;
  sheet.alpha = 1.f;
  sheet.alphaCutoff = 0.5f;
  scene::PunctualLight sun;
  sun.intensity = glm::vec3(1.f);
  scene.lights = {sun};
  EXPECT_EQ(probe(scene, {-0.5, 0, 0}, {0, 1, 0}, 0, 4).direct.x, 0.f) << "under the sheet";
  EXPECT_FLOAT_EQ(probe(scene, {0.5, 0, 0}, {0, 1, 0}, 0, 4).direct.x, 1.f) << "under the hole";
  // The sky through the hole: only the opaque half hides some of it.
  scene.lights.clear();
  scene.skyRadiance = glm::vec3(1.f);
  const double hidden = oracles::pointToPolygon({0.5, 0, 0.2}, {0, 1, 0}, {{-1, 1, 1}, {0, 1, 1}, {0, 1, -1}, {-1, 1, -1}});
  const reference::ProbeValue value = probe(scene, {0.5, 0, 0.2}, {0, 1, 0}, 0, 8192);
  expectWithin(static_cast<double>(value.direct.x), static_cast<double>(value.directError.x), kPi * (1 - hidden), "sky");
  // The camera sees through it, too: half of it has the sheet's albedo.
  const auto camera = lookAtSquare(scene, {0, 2, 0}, {0, -1, 0}, {0, 0, -1}, 1);
  const reference::Images images = reference::PathTracer(scene).render(camera, {.width = 2, .height = 2, .bounces = 0, .spp = 16});
  EXPECT_FLOAT_EQ(images.albedo.mean.data[0], 0.5f);
  EXPECT_EQ(images.albedo.mean.data[3], 0.f);
  // A factor below the cutoff leaves nothing, without any texture.
  findMaterial(scene, "sheet").baseTexture = shared::kNoTexture;
  findMaterial(scene, "sheet").alpha = 0.4f;
  EXPECT_FLOAT_EQ(probe(scene, {-0.5, 0, 0}, {0, 1, 0}, 0, 4).direct.x, static_cast<float>(kPi));
}

TEST(ReferenceLights, EmissionFollowsTextureAndMask) {
  for (const bool byMask : {false, true}) {
    scene::Scene scene = makeSheet(byMask ? shared::kMaterialAlphaMask : 0u, glm::vec3(2.f), true);
    scene.textures = {halves()};
    shared::Material& sheet = findMaterial(scene, "sheet");
    (byMask ? sheet.baseTexture : sheet.emissiveTexture) = 0;
    sheet.alpha = 1.f;
    sheet.alphaCutoff = 0.5f;
    const glm::dvec3 p(0.3, 0, 0.1);
    const double exact = 2 * kPi * oracles::pointToPolygon(p, {0, 1, 0}, {{-1, 1, 1}, {0, 1, 1}, {0, 1, -1}, {-1, 1, -1}});
    const reference::ProbeValue value = probe(scene, p, {0, 1, 0}, 0, 32768);
    expectWithin(static_cast<double>(value.direct.x), static_cast<double>(value.directError.x), exact, byMask ? "mask" : "texture");
  }
}

TEST(ReferenceLights, EmissionIsOneSidedAndReflectionTwoSided) {
  const scene::Scene scene = makeSheet(0, glm::vec3(2.f), false);  // front up
  EXPECT_EQ(probe(scene, {0, 0, 0}, {0, 1, 0}, 0, 64).direct.x, 0.f) << "its back is dark";
  EXPECT_GT(probe(scene, {0, 2, 0}, {0, -1, 0}, 0, 64).direct.x, 0.1f);
  // Sunlight on the sheet's back, by way of nothing else, is reflected downwards.
  scene::Scene lit = makeSheet(0, glm::vec3(0.f), false);
  scene::PunctualLight up;
  up.direction = {0.f, 1.f, 0.f};
  up.intensity = glm::vec3(1.f);
  up.type = shared::kLightDirectional;
  lit.lights = {up};
  findMaterial(lit, "ground").flags |= shared::kMaterialAlphaMask;  // cut away, so that the sun comes through
  findMaterial(lit, "ground").alpha = 0.f;
  findMaterial(lit, "ground").alphaCutoff = 0.5f;
  const double f = oracles::pointToPolygon({0, 0, 0}, {0, 1, 0}, {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}});
  const reference::ProbeValue value = probe(lit, {0, 0, 0}, {0, 1, 0}, 1, 4096);
  expectWithin(static_cast<double>(value.indirect.x), static_cast<double>(value.indirectError.x), 0.5 * f, "from the back", 0.02);
}

TEST(ReferenceLights, GltfSidesAreThereFromTheFrontOnly) {
  // The sheet's front is up. Light from above meets it; seen from below it is not there.
  scene::Scene scene = makeSheet(0, glm::vec3(0.f), false);
  scene::PunctualLight sun;
  sun.intensity = glm::vec3(1.f);
  scene.lights = {sun};
  const reference::ProbePoint below{{0.f, 0.f, 0.f}, {0.f, 1.f, 0.f}};
  const reference::ProbeSettings settings{.bounces = 1, .spp = 64};
  const reference::PathTracer gltf(scene, reference::Sides::Gltf);
  EXPECT_EQ(gltf.probe({&below, 1}, settings)[0].direct.x, 0.f) << "the shadow is cast by its front";
  scene.lights[0].direction = {0.f, 1.f, 0.f};
  const reference::ProbePoint above{{0.f, 2.f, 0.f}, {0.f, -1.f, 0.f}};
  EXPECT_FLOAT_EQ(reference::PathTracer(scene, reference::Sides::Gltf).probe({&above, 1}, settings)[0].direct.x, 0.f)
      << "the ground is double-sided";
  findMaterial(scene, "ground").flags = 0;
  EXPECT_FLOAT_EQ(reference::PathTracer(scene, reference::Sides::Gltf).probe({&above, 1}, settings)[0].direct.x, 1.f)
      << "neither back is there";
  EXPECT_EQ(reference::PathTracer(scene).probe({&above, 1}, settings)[0].direct.x, 0.f);
  // The sky, looked for from below: through the back.
  scene.lights.clear();
  scene.skyRadiance = glm::vec3(1.f);
  EXPECT_NEAR(reference::PathTracer(scene, reference::Sides::Gltf).probe({&below, 1}, settings)[0].direct.x, static_cast<float>(kPi),
              1e-4f);
  // An emitter through such a back: the shadow's word.
  scene = makeSheet(0, glm::vec3(0.f), false);
  EXPECT_NE(gltf.fingerprint(), reference::PathTracer(scene).fingerprint());
}

TEST(ReferenceLights, TexturesAreReadAsTheHostReadsThem) {
  scene::Scene scene = makeSheet(0, glm::vec3(0.f), false);
  scene::TextureImage image;
  image.width = 4;
  image.height = 4;
  image.wrapU = shared::kWrapMirror;
  for (int i = 0; i < 16; ++i) {
    for (const int value : {i * 16, 255 - i * 9, (i * 37) % 256, 255}) image.rgba.push_back(static_cast<uint8_t>(value));
  }
  scene.textures = {image};
  findMaterial(scene, "sheet").baseTexture = 0;
  findMaterial(scene, "sheet").albedo = glm::vec3(0.9f);
  const auto camera = lookAtSquare(scene, {0, 2, 0}, {0, -1, 0}, {0, 0, -1}, 1);
  const reference::Images images = reference::PathTracer(scene).render(camera, {.width = 8, .height = 8, .bounces = 0, .spp = 256});
  for (uint32_t x = 0; x < 8; ++x) {
    glm::dvec3 exact(0.0);
    for (int k = 0; k < 64; ++k)
      exact +=
          0.9 *
          glm::dvec3(glm::vec3(scene::sampleTexture(image, {(static_cast<float>(x) + (static_cast<float>(k) + 0.5f) / 64) / 8, 0.5f}))) /
          64.0;
    for (uint32_t c = 0; c < 3; ++c) {
      const size_t at = 3 * (3 * 8 + x) + c;
      const double error = std::sqrt(static_cast<double>(images.albedo.variance.data[at]));
      EXPECT_NEAR(static_cast<double>(images.albedo.mean.data[at]), exact[static_cast<glm::length_t>(c)], 4 * error + 1e-4) << x;
    }
  }
}

}  // namespace
}  // namespace radivox::reference_test
