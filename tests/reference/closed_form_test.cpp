// The path tracer against answers known in closed form, within three standard errors.
#include <numbers>

#include "tests/oracles/form_factors.h"
#include "tests/reference/reference_fixture.h"

namespace radivox::reference_test {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ReferenceClosedForm, FurnaceIsOneEverywhere) {
  // L_e = (1 − ρ)/π: E is π L_e directly, ρ^k of that after k bounces, 1 in all.
  for (const double albedo : {0.5, 0.9}) {
    const scene::Scene scene = scene::loadScene("builtin:furnace?albedo=" + std::to_string(albedo));
    const reference::PathTracer tracer(scene);
    for (const uint32_t bounces : {0u, 1u, 3u, scene::kAllBounces}) {
      const reference::Images images =
          tracer.render(scene.cameras[0], {.width = 16, .height = 16, .bounces = bounces, .spp = 128, .seed = bounces});
      double indirect = 0, term = 1 - albedo;
      for (uint32_t k = 1; k <= std::min(bounces, 2000u); ++k) indirect += term *= albedo;
      const std::string what = std::to_string(albedo) + ", bounces " + std::to_string(bounces);
      const Mean direct = meanOf(images.irradianceDirect), rest = meanOf(images.irradianceIndirect), color = meanOf(images.color);
      expectWithin(direct.value, direct.standardError, 1 - albedo, "direct, albedo " + what);
      if (bounces == 0) {
        EXPECT_EQ(rest.value, 0);
      } else {
        expectWithin(rest.value, rest.standardError, indirect, "indirect, albedo " + what);
      }
      expectWithin(color.value, color.standardError, (albedo * (1 - albedo + indirect) + 1 - albedo) / kPi, "color, albedo " + what);
    }
  }
}

TEST(ReferenceClosedForm, HollowSphereReflectsTheSameEverywhere) {
  // A lamp in the middle of a white sphere of radius 1, I = 1: E is 1, and each reflection adds ρ of the one before, evenly. The sphere is
  // made of flat triangles, whose points lie up to a thousandth nearer.
  const scene::Scene scene = scene::loadScene("builtin:sphere?albedo=0.6&inward=1&rings=48");
  const reference::PathTracer tracer(scene);
  for (const uint32_t bounces : {1u, 2u, scene::kAllBounces}) {
    const reference::Images images = tracer.render(scene.cameras[0], {.width = 12, .height = 12, .bounces = bounces, .spp = 256});
    const double exact = bounces == 1 ? 0.6 : bounces == 2 ? 0.6 + 0.36 : 1.5;
    const Mean direct = meanOf(images.irradianceDirect), indirect = meanOf(images.irradianceIndirect);
    EXPECT_NEAR(direct.value, 1.0, 2e-3);
    EXPECT_NEAR(indirect.value, exact, 3 * indirect.standardError + 3e-3 * exact);
    EXPECT_LT(indirect.standardError, 4e-3 * exact);
  }
}

TEST(ReferenceClosedForm, SphereOfKnownRadianceAtADistance) {
  // A ball of radiance L seen whole: E = π L (r/d)² facing it, times the cosine while it is above the horizon.
  scene::MeshBuilder mesh("ball");
  const uint32_t lamp = mesh.addMaterial("lamp", glm::vec3(0.f), glm::vec3(2.f), shared::kMaterialEmissive);
  scene::addBall(
      mesh, glm::dvec3(0, 3, 0), [](const glm::dvec3&) { return 0.75; }, 64, false, lamp);
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  for (const double tilt : {0.0, 0.5, 1.0}) {
    const glm::dvec3 n(std::sin(tilt), std::cos(tilt), 0);
    const reference::ProbeValue value = probe(scene, glm::dvec3(0), n, 0, 32768);
    // The polyhedron's silhouette is 4e-4 smaller than the ball's.
    const double exact = kPi * 2 * (0.75 / 3) * (0.75 / 3) * std::cos(tilt);
    EXPECT_NEAR(static_cast<double>(value.direct.x), exact, 3 * static_cast<double>(value.directError.x) + 5e-4 * exact) << tilt;
    EXPECT_LT(value.directError.x, 0.005 * exact);
  }
}

TEST(ReferenceClosedForm, SlowConvexBodyUnderAnEvenSky) {
  // Nothing hides the sky from a convex body: E = π L on every side of a box, and nothing is reflected onto it.
  scene::MeshBuilder mesh("block");
  mesh.addBlock(glm::dvec3(0), glm::dvec3(1), 0.3, mesh.addMaterial("grey", glm::vec3(0.8f)));
  mesh.setSky(glm::vec3(0.5f, 1.f, 2.f));
  mesh.addCamera("c", {2, 2, 3}, {0, 0, 0}, 0.4);
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  const reference::PathTracer tracer(scene);
  const reference::Images images = tracer.render(scene.cameras[0], {.width = 16, .height = 16, .spp = 64});
  const size_t middle = 3 * (8 * 16 + 8);
  const std::array<float, 3> sky = {0.5f, 1.f, 2.f};
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(images.irradianceDirect.mean.data[middle + c], kPi * static_cast<double>(sky[c]), 1e-5);
    EXPECT_EQ(images.irradianceIndirect.mean.data[middle + c], 0.f);
    EXPECT_NEAR(images.color.mean.data[middle + c], 0.8 * static_cast<double>(sky[c]), 1e-5);
    EXPECT_FLOAT_EQ(images.color.mean.data[c], sky[c]) << "the sky itself";
    EXPECT_EQ(images.irradianceDirect.mean.data[c], 0.f);
  }
}

TEST(ReferenceClosedForm, ParallelSquares) {
  // The lamp faces down at height 1; the camera, between them, sees exactly the square below.
  for (const double side : {1.0, 3.0}) {
    scene::MeshBuilder mesh("squares");
    const uint32_t grey = mesh.addMaterial("grey", glm::vec3(0.f));
    const uint32_t lamp = mesh.addMaterial("lamp", glm::vec3(0.f), glm::vec3(1.f), shared::kMaterialEmissive);
    const double h = side / 2;
    mesh.addQuad({-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h}, grey);
    mesh.addQuad({-h, 1, h}, {-h, 1, -h}, {h, 1, -h}, {h, 1, h}, lamp);
    const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
    const auto camera = lookAtSquare(scene, {0, 0.5, 0}, {0, -1, 0}, {0, 0, -1}, h);
    const reference::Images images = reference::PathTracer(scene).render(camera, {.width = 16, .height = 16, .bounces = 0, .spp = 1024});
    const Mean e = meanOf(images.irradianceDirect);
    expectWithin(e.value / kPi, e.standardError / kPi, oracles::parallelSquares(side, 1.0), "side " + std::to_string(side), 1e-3);
  }
  EXPECT_NEAR(oracles::parallelSquares(1, 1), 0.1998, 5e-5);
}

TEST(ReferenceClosedForm, CubeFormFactors) {
  // One face of a black cube emits.
  scene::MeshBuilder mesh("cube");
  const uint32_t black = mesh.addMaterial("black", glm::vec3(0.f));
  const uint32_t lamp = mesh.addMaterial("lamp", glm::vec3(0.f), glm::vec3(1.f), shared::kMaterialEmissive);
  addCube(mesh, {black, black, lamp, black, black, black});
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  const reference::PathTracer tracer(scene);
  const reference::Settings settings{.width = 16, .height = 16, .bounces = 0, .spp = 256};
  const auto opposite = tracer.render(lookAtSquare(scene, {0.5, 0.5, 0.5}, {0, 1, 0}, {0, 0, 1}, 0.5), settings);
  const auto adjacent = tracer.render(lookAtSquare(scene, {0.5, 0.5, 0.5}, {1, 0, 0}, {0, 1, 0}, 0.5), settings);
  const Mean far = meanOf(opposite.irradianceDirect), near = meanOf(adjacent.irradianceDirect);
  expectWithin(far.value / kPi, far.standardError / kPi, oracles::parallelSquares(1, 1), "opposite", 1e-3);
  expectWithin(near.value / kPi, near.standardError / kPi, oracles::adjacentCubeFaces(), "adjacent", 2e-3);
  EXPECT_NEAR(oracles::adjacentCubeFaces(), 0.2000, 5e-5);
}

TEST(ReferenceClosedForm, OneBounceBetweenSquares) {
  // The sun shines aslant, past the upper square's edge, on the whole of the lower one: E on the upper one is ρ E_sun F.
  scene::MeshBuilder mesh("bounce");
  const uint32_t white = mesh.addMaterial("white", glm::vec3(0.8f, 0.4f, 0.2f));
  const uint32_t black = mesh.addMaterial("black", glm::vec3(0.f));
  mesh.addQuad({-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0, -0.5}, {-0.5, 0, -0.5}, white);
  mesh.addQuad({-0.5, 1, 0.5}, {-0.5, 1, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}, black);
  mesh.addSun({0, -0.7, 1}, glm::vec3(10.f));
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  const auto camera = lookAtSquare(scene, {0, 0.5, 0}, {0, 1, 0}, {0, 0, -1}, 0.5);
  const reference::Images images = reference::PathTracer(scene).render(camera, {.width = 16, .height = 16, .bounces = 1, .spp = 1024});
  const double sun = 10 * 0.7 / std::sqrt(1 + 0.49);
  const std::array<double, 3> albedo = {0.8, 0.4, 0.2};
  for (uint32_t c = 0; c < 3; ++c) {
    const Mean e = meanOf(images.irradianceIndirect, c);
    expectWithin(e.value, e.standardError, albedo[c] * sun * oracles::parallelSquares(1, 1), "channel " + std::to_string(c), 3e-3);
  }
  EXPECT_EQ(meanOf(images.irradianceDirect).value, 0) << "the sun is above";
}

TEST(ReferenceClosedForm, PointLightOverAPlane) {
  scene::MeshBuilder mesh("plane");
  const uint32_t grey = mesh.addMaterial("grey", glm::vec3(0.5f));
  mesh.addQuad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, grey);
  mesh.addPointLight({0, 2, 0}, {3.f, 2.f, 1.f});
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  for (const double x : {0.0, 1.0, 3.0}) {
    const reference::ProbeValue value = probe(scene, {x, 0, 0}, {0, 1, 0}, scene::kAllBounces, 16);
    const double exact = 2 / std::pow(4 + x * x, 1.5);
    EXPECT_NEAR(value.direct.x, 3 * exact, 1e-5);
    EXPECT_NEAR(value.direct.z, exact, 1e-5);
    EXPECT_LT(value.directError.x, 1e-6) << "nothing to guess";
    EXPECT_EQ(value.indirect.x, 0.f) << "a plane does not see itself";
  }
  // From a camera: the mean over each pixel.
  const auto camera = lookAtSquare(scene, {0, 1, 0}, {0, -1, 0}, {0, 0, -1}, 2);
  const reference::Images images = reference::PathTracer(scene).render(camera, {.width = 4, .height = 4, .spp = 256});
  for (uint32_t i = 0; i < 16; ++i) {
    double exact = 0;
    for (int k = 0; k < 400; ++k) {
      const double x = -2.0 + (i % 4) + (k % 20 + 0.5) / 20, z = -2.0 + (i / 4) + (k / 20 + 0.5) / 20;
      exact += 2 / std::pow(4 + x * x + z * z, 1.5) / 400;
    }
    const auto value = static_cast<double>(images.irradianceDirect.mean.data[3 * i + 2]);
    EXPECT_NEAR(value, exact, 4 * std::sqrt(static_cast<double>(images.irradianceDirect.variance.data[3 * i + 2])) + 1e-4 * exact) << i;
    EXPECT_NEAR(images.direct.mean.data[3 * i + 2], value * 0.5 / kPi, 1e-5);
  }
}

TEST(ReferenceClosedForm, EmissiveQuadOverAPlane) {
  scene::MeshBuilder mesh("quad");
  const uint32_t grey = mesh.addMaterial("grey", glm::vec3(0.5f));
  const uint32_t lamp = mesh.addMaterial("lamp", glm::vec3(0.f), glm::vec3(4.f, 2.f, 1.f), shared::kMaterialEmissive);
  const std::vector<glm::dvec3> quad = {{-0.5, 1, 0.7}, {-0.5, 1, -0.7}, {0.5, 1, -0.7}, {0.5, 1, 0.7}};
  mesh.addQuad({-8, 0, 8}, {8, 0, 8}, {8, 0, -8}, {-8, 0, -8}, grey);
  mesh.addQuad(quad[0], quad[1], quad[2], quad[3], lamp);
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  const std::array<std::pair<glm::dvec3, glm::dvec3>, 5> places = {{{{0, 0, 0}, {0, 1, 0}},
                                                                    {{0.8, 0, 0.3}, {0, 1, 0}},
                                                                    {{5, 0, 1}, {0, 1, 0}},
                                                                    {{0.1, 0.95, 0.1}, {0, 1, 0}},  // close below: directions find it
                                                                    {{-2, 0.2, 0}, {1, 0, 0}}}};
  for (const auto& [p, n] : places) {
    const reference::ProbeValue value = probe(scene, p, n, 0, 4096);
    const double exact = kPi * oracles::pointToPolygon(p, n, quad);
    expectWithin(static_cast<double>(value.direct.z), static_cast<double>(value.directError.z), exact,
                 "at " + std::to_string(p.x) + " " + std::to_string(p.y), 5e-3);
    EXPECT_NEAR(value.direct.x, 4 * value.direct.z, 1e-4 * value.direct.x);
  }
  // Behind the lamp it is dark.
  EXPECT_EQ(probe(scene, {0, 2, 0}, {0, -1, 0}, 0, 64).direct.x, 0.f);
  EXPECT_NEAR(oracles::pointToPolygon({0, 0, 0}, {0, 1, 0}, {{-0.5, 1, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}, {-0.5, 1, 0.5}}), 0.2395,
              5e-5);
}

TEST(ReferenceClosedForm, FarFromTheOriginAndTinyOrHuge) {
  // The furnace's answer knows no scale; rays that start on their own surface, or past the next one, would show.
  for (const char* where : {"scale=0.001", "scale=10000", "offset=1000000", "scale=0.01&offset=100000"}) {
    const scene::Scene scene = scene::loadScene(std::string("builtin:furnace?albedo=0.5&") + where);
    const reference::Images images =
        reference::PathTracer(scene).render(scene.cameras[0], {.width = 16, .height = 16, .bounces = 2, .spp = 128});
    const Mean direct = meanOf(images.irradianceDirect), indirect = meanOf(images.irradianceIndirect);
    expectWithin(direct.value, direct.standardError, 0.5, std::string("direct, ") + where);
    expectWithin(indirect.value, indirect.standardError, 0.375, std::string("indirect, ") + where);
  }
}

}  // namespace
}  // namespace radivox::reference_test
