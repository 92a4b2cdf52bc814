// Sky light in whole pictures: what of it bounces, against the path tracer and closed forms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "engine/scene/sky.h"
#include "shaders/shared/voxel.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/truth.h"
#include "tests/reference/reference_fixture.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

constexpr uint32_t kWidth = 160, kHeight = 90;
constexpr double kPi = 3.14159265358979323846;

PipelineOptions optionsOf(const std::string& graph, uint32_t resolution) {
  PipelineOptions options;
  options.graph = graph;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}};
  options.outputs = {"composite.color", "composite.direct", "composite.irradiance_direct", "composite.indirect_radiance"};
  options.width = kWidth;
  options.height = kHeight;
  return options;
}

class Sky : public oracles::GpuTest {
 protected:
  struct Quality {
    oracles::Difference direct, indirect;
  };
  /// Prints what it measured.
  Quality measure(const scene::Scene& scene, const reference::Images& truth, const std::string& graph, const char* what,
                  uint32_t voxelRays = 0) {
    PipelineOptions options = optionsOf(graph, 64);
    if (voxelRays > 0) options.settings.emplace_back("visibility.rays", std::to_string(voxelRays));
    Pipeline p(device(), scene, options);
    p.run();
    Quality q;
    // Radiance: of pixels that the sky shares, the path tracer's irradiance is the surface's alone.
    q.direct = oracles::compareToTruth(truth.direct.mean, p.picture("composite.direct"), truth.albedo.mean);
    q.indirect = oracles::compareToTruth(truth.indirect.mean, p.picture("composite.indirect_radiance"), truth.albedo.mean);
    std::printf("%s, %s: direct %.2f dB (bias %.4f), indirect %.2f dB (bias %.4f)\n", what, graph.c_str(), q.direct.psnr, q.direct.bias,
                q.indirect.psnr, q.indirect.bias);
    return q;
  }
  void expectAgrees(const scene::Scene& scene, const char* what) {
    const reference::Images truth = traceTruth(scene);
    for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
      const Quality q = measure(scene, truth, graph, what);
      EXPECT_NEAR(q.direct.bias, 1, 0.02) << graph;
      EXPECT_NEAR(q.indirect.bias, 1, 0.03) << graph;
    }
  }
  reference::Images traceTruth(const scene::Scene& scene) {
    return reference::PathTracer(scene).render(scene.cameras.front(), {.width = kWidth, .height = kHeight, .spp = 256});
  }
};

/// A court of 2 × 2 × 1.5 m with walls of three colours and a block in it, open above, under the sky alone.
scene::Scene courtUnder(const glm::vec3& radiance) {
  scene::MeshBuilder mesh("court");
  const uint32_t grey = mesh.addMaterial("grey", glm::vec3(0.7f)), red = mesh.addMaterial("red", glm::vec3(0.8f, 0.2f, 0.2f)),
                 green = mesh.addMaterial("green", glm::vec3(0.2f, 0.7f, 0.3f));
  mesh.addQuad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, grey);
  mesh.addQuad({-1, 0, -1}, {1, 0, -1}, {1, 1.5, -1}, {-1, 1.5, -1}, grey);
  mesh.addQuad({-1, 0, 1}, {-1, 0, -1}, {-1, 1.5, -1}, {-1, 1.5, 1}, red);
  mesh.addQuad({1, 0, -1}, {1, 0, 1}, {1, 1.5, 1}, {1, 1.5, -1}, green);
  mesh.addBlock({0.2, 0.35, -0.2}, {0.6, 0.7, 0.6}, 0.4, grey);
  mesh.setSky(radiance);
  mesh.addCamera("c", {0, 1.6, 3.4}, {0, 0.55, 0}, 0.7);
  return mesh.finish(1.0, glm::dvec3(0));
}

TEST_F(Sky, SlowAnEvenSkyBouncesAsThePathTracerSays) {
  const scene::Scene scene = courtUnder({0.6f, 0.8f, 1.f});
  expectAgrees(scene, "even sky");
}

// Direct light alone has the sky's, too.
TEST_F(Sky, SlowZeroBouncesKeepTheSkysLight) {
  const scene::Scene scene = courtUnder(glm::vec3(1.f));
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    PipelineOptions options = optionsOf(graph, 24);
    Pipeline all(device(), scene, options);
    options.bounces = 0;
    Pipeline none(device(), scene, options);
    all.run();
    none.run();
    EXPECT_EQ(none.picture("composite.irradiance_direct").data, all.picture("composite.irradiance_direct").data);
    EXPECT_GT(none.picture("composite.irradiance_direct").at(kWidth / 2, kHeight / 2, 0), 0.5f);
  }
}

// Nothing hides the sky from a convex body, and nothing shines on it: E = π L.
TEST_F(Sky, SlowConvexBodyUnderAnEvenSky) {
  scene::MeshBuilder mesh("block");
  mesh.addBlock(glm::dvec3(0), glm::dvec3(1), 0, mesh.addMaterial("grey", glm::vec3(0.8f)));
  mesh.setSky(glm::vec3(0.5f, 1.f, 2.f));
  mesh.addCamera("c", {2, 2, 3}, {0, 0, 0}, 0.4);
  const scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    SCOPED_TRACE(graph);
    PipelineOptions options = optionsOf(graph, 16);
    options.outputs = {"composite.color", "composite.irradiance_direct", "composite.indirect_radiance", "sky.irradiance",
                       "inject.face_irradiance"};
    Pipeline p(device(), scene, options);
    p.run();
    for (const char* port : {"sky.irradiance", "inject.face_irradiance"}) {
      const auto irradiance = p.buffer<glm::vec3>(port, p.count("faces"));
      size_t lit = 0;
      for (const glm::vec3& e : irradiance) {
        if (e == glm::vec3(0.f)) continue;  // an inner side
        ++lit;
        for (glm::length_t c = 0; c < 3; ++c) ASSERT_NEAR(e[c], 3.14159265f * scene.skyRadiance[c], 1e-5f * scene.skyRadiance[c]);
      }
      EXPECT_GE(lit, irradiance.size() / 2);
    }
    const image::Image direct = p.picture("composite.irradiance_direct"), indirect = p.picture("composite.indirect_radiance");
    for (uint32_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(direct.at(kWidth / 2, kHeight / 2, c), 3.14159265f * scene.skyRadiance[static_cast<glm::length_t>(c)], 1e-4f);
      EXPECT_EQ(indirect.at(kWidth / 2, kHeight / 2, c), 0.f);
      EXPECT_EQ(direct.at(0, 0, c), 0.f);
    }
  }
}

// Another sky traces no ray.
TEST_F(Sky, SlowAnotherSkyLeavesVisibilityAsItIs) {
  scene::Scene scene = courtUnder(glm::vec3(1.f));
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    Pipeline p(device(), scene, optionsOf(graph, 24));
    p.run();
    const image::Image once = p.picture("composite.color");
    scene::Scene brighter = scene;
    brighter.skyRadiance = glm::vec3(2.f);
    p.setLights(brighter);
    p.run();
    EXPECT_EQ(p.runCount("visibility"), 1u);
    EXPECT_EQ(p.runCount("transfer"), 1u);
    EXPECT_EQ(p.runCount("sky"), 2u);
    const image::Image twice = p.picture("composite.color");
    double sum = 0, doubled = 0;
    for (const float value : once.data) sum += static_cast<double>(value);
    for (const float value : twice.data) doubled += static_cast<double>(value);
    EXPECT_NEAR(doubled / sum, 2, 1e-3);
    // And the same bits as from the start.
    Pipeline anew(device(), brighter, optionsOf(graph, 24));
    anew.run();
    EXPECT_EQ(anew.picture("composite.color").data, twice.data);
  }
}

/// Radiance by direction, at the middles of texels.
std::shared_ptr<const scene::Sky> paintSky(const std::function<glm::vec3(const glm::dvec3&)>& radiance, double turn = 0) {
  scene::Sky frame;
  frame.width = 256;
  frame.height = 128;
  image::Image image{frame.width, frame.height, 3, {}};
  for (uint32_t y = 0; y < image.height; ++y) {
    for (uint32_t x = 0; x < image.width; ++x) {
      const glm::vec3 value = radiance(frame.direction((x + 0.5) / image.width, (y + 0.5) / image.height));
      image.data.insert(image.data.end(), {value.x, value.y, value.z});
    }
  }
  return scene::makeSky(image, "painted", 1, turn);
}

scene::Scene openPlane(std::shared_ptr<const scene::Sky> sky) {
  scene::MeshBuilder mesh("plane");
  mesh.addQuad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, mesh.addMaterial("grey", glm::vec3(0.5f)));
  mesh.addCamera("c", {0, 2, 0}, {0, 0, 0.001}, 0.4);
  scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  scene.sky = std::move(sky);
  return scene;
}

TEST(SkyInClosedForm, AGradientOnAnOpenPlane) {
  // L = a + b cos θ: E = π a + 2π b / 3 from above, and with the normal square to the gradient π a.
  const auto sky = paintSky([](const glm::dvec3& d) { return glm::vec3(static_cast<float>(1 + 0.5 * d.y)); });
  const scene::Scene scene = openPlane(sky);
  const reference::ProbeValue up = reference_test::probe(scene, {0, 0, 0}, {0, 1, 0}, 0, 16384);
  const double exact = kPi * (1 + 2 * 0.5 / 3);
  reference_test::expectWithin(up.direct.x, up.directError.x, exact, "up", 1e-3);
  scene::Scene nothing = scene;
  const reference::ProbeValue side = reference_test::probe(nothing, {0, 5, 0}, {1, 0, 0}, 0, 16384);
  // The plane five metres below hides a little of the lower half.
  EXPECT_NEAR(side.direct.x, kPi, 0.02);
}

TEST(SkyInClosedForm, HalfASkyOnAnOpenPlane) {
  const scene::Scene scene = openPlane(paintSky([](const glm::dvec3& d) { return glm::vec3(d.x > 0 ? 1 : 0, 0.25, 0); }));
  const reference::ProbeValue value = reference_test::probe(scene, {0, 0, 0}, {0, 1, 0}, 0, 16384);
  reference_test::expectWithin(value.direct.x, value.directError.x, kPi / 2, "half", 2e-3);
  reference_test::expectWithin(value.direct.y, value.directError.y, kPi / 4, "even", 1e-3);
  EXPECT_EQ(value.direct.z, 0.f);
}

// What no path would find by chance: a sun of a few texels, 10⁵ times as bright as the rest.
TEST(SkyInClosedForm, ASunOnAnOpenPlane) {
  const scene::Scene scene = openPlane(scene::loadSky("builtin:clear"));
  const scene::Sky& sky = *scene.sky;
  double exact = 0;
  for (uint32_t y = 0; y < sky.height / 2; ++y) {
    // ∫ cos θ over a texel's rows is the difference of sin² θ / 2.
    const double top = std::sin(kPi * y / sky.height), bottom = std::sin(kPi * (y + 1) / sky.height);
    for (uint32_t x = 0; x < sky.width; ++x)
      exact += 0.5 * (bottom * bottom - top * top) * 2 * kPi / sky.width * static_cast<double>(sky.texels[size_t{y} * sky.width + x].y);
  }
  const reference::ProbeValue value = reference_test::probe(scene, {0, 0, 0}, {0, 1, 0}, 0, 4096);
  reference_test::expectWithin(value.direct.y, value.directError.y, exact, "sun and sky", 5e-3);
  // The renderer's light for it brings the same.
  EXPECT_NEAR(-sky.suns.at(0).direction.y * sky.suns.at(0).intensity.y, 8 * std::sin(40 * kPi / 180), 0.1);
}

TEST(SkyImageReference, AnotherSkyIsAnotherScene) {
  const auto sky = [](double turn) { return paintSky([](const glm::dvec3& d) { return glm::vec3(static_cast<float>(1 + d.x)); }, turn); };
  const uint64_t one = reference::PathTracer(openPlane(sky(0))).fingerprint();
  EXPECT_EQ(reference::PathTracer(openPlane(sky(0))).fingerprint(), one);
  EXPECT_NE(reference::PathTracer(openPlane(sky(5))).fingerprint(), one);
  EXPECT_NE(reference::PathTracer(openPlane(nullptr)).fingerprint(), one);
}

TEST_F(Sky, SlowAnImageBouncesAsThePathTracerSays) {
  scene::Scene scene = courtUnder(glm::vec3(0.f));
  scene.sky = paintSky([](const glm::dvec3& d) {
    const double spot = std::exp(8 * (glm::dot(d, glm::normalize(glm::dvec3(1, 1, 0.5))) - 1));
    return glm::vec3(0.2 + 3 * spot, 0.4 + 2 * spot, 0.7 + 0.5 * d.y + spot);
  });
  EXPECT_TRUE(scene.sky->suns.empty());
  expectAgrees(scene, "painted sky");
}

TEST_F(Sky, SlowASunOfTheImageIsALight) {
  scene::Scene scene = courtUnder(glm::vec3(0.f));
  scene.sky = scene::loadSky("builtin:clear");
  ASSERT_EQ(scene.sky->suns.size(), 1u);
  expectAgrees(scene, "clear sky");
}

// Turned a quarter, the light of each side of a block is that of the next.
TEST_F(Sky, SlowTurnsWithItsImage) {
  scene::MeshBuilder mesh("block");
  mesh.addBlock(glm::dvec3(0), glm::dvec3(1), 0, mesh.addMaterial("grey", glm::vec3(0.8f)));
  mesh.addCamera("c", {2, 2, 3}, {0, 0, 0}, 0.4);
  scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  const auto meansUnder = [&](double turn) {
    scene.sky = paintSky([](const glm::dvec3& d) { return glm::vec3(1 + d.x, 1 + 0.5 * d.z, 1 + d.y); }, turn);
    PipelineOptions options = optionsOf("clustered_voxel", 16);
    options.outputs = {"sky.irradiance", "surface.faces"};
    options.settings.push_back({"visibility.rays", "256"});
    Pipeline p(device(), scene, options);
    p.run();
    const auto irradiance = p.buffer<glm::vec3>("sky.irradiance", p.count("faces"));
    const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
    std::array<glm::dvec3, 6> sums{};
    std::array<double, 6> counts{};
    for (size_t s = 0; s < faces.size(); ++s) {
      if (irradiance[s] == glm::vec3(0.f)) continue;  // an inner side
      sums[faces[s].key & 7u] += glm::dvec3(irradiance[s]);
      counts[faces[s].key & 7u] += 1;
    }
    for (size_t f = 0; f < 6; ++f) sums[f] /= counts[f];
    return sums;
  };
  const auto still = meansUnder(0), turned = meansUnder(90);
  // +z → +x, +x → −z, −z → −x, −x → +z; up and down stay.
  const std::array<size_t, 6> before = {4, 5, 2, 3, 1, 0};
  for (size_t f = 0; f < 6; ++f) {
    for (glm::length_t c = 0; c < 3; ++c) EXPECT_NEAR(turned[f][c] / still[before[f]][c], 1, 0.01) << f;
  }
  // E = π (1 + 2/3 · slope).
  EXPECT_NEAR(still[0].x, kPi * (1 + 2. / 3), 0.05);
  EXPECT_NEAR(still[2].z, kPi * (1 + 2. / 3), 0.05);
  EXPECT_NEAR(still[3].z, kPi * (1 - 2. / 3), 0.05);
}

// An even image is the constant sky, in light and behind the scene; and the same bits each time.
TEST_F(Sky, SlowAnEvenImageIsAConstantSky) {
  scene::Scene scene = courtUnder(glm::vec3(0.75f));
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    SCOPED_TRACE(graph);
    scene.skyRadiance = glm::vec3(0.75f);
    scene.sky = nullptr;
    Pipeline constant(device(), scene, optionsOf(graph, 24));
    constant.run();
    scene.skyRadiance = glm::vec3(0.25f);  // the rest of it
    scene.sky = paintSky([](const glm::dvec3&) { return glm::vec3(0.5f); });
    Pipeline even(device(), scene, optionsOf(graph, 24)), again(device(), scene, optionsOf(graph, 24));
    even.run();
    again.run();
    const image::Image expected = constant.picture("composite.color"), found = even.picture("composite.color");
    for (size_t i = 0; i < expected.data.size(); ++i) ASSERT_NEAR(found.data[i], expected.data[i], 1e-3f * expected.data[i]) << i;
    EXPECT_EQ(again.picture("composite.color").data, found.data);
    // Another image traces no ray either.
    scene.sky = paintSky([](const glm::dvec3& d) { return glm::vec3(static_cast<float>(0.5 + 0.4 * d.y)); });
    even.setLights(scene);
    even.run();
    EXPECT_EQ(even.runCount("visibility"), 1u);
    Pipeline anew(device(), scene, optionsOf(graph, 24));
    anew.run();
    EXPECT_EQ(anew.picture("composite.color").data, even.picture("composite.color").data);
  }
}

// What the camera sees of the sky is the image, as the path tracer shows it.
TEST_F(Sky, TheBackgroundIsTheImage) {
  scene::Scene scene = scene::loadScene("builtin:empty");
  scene.sky = paintSky([](const glm::dvec3& d) { return glm::vec3(1.5 + d.x, 1.5 + d.y, 1.5 + d.z); }, 20);
  const reference::Images truth =
      reference::PathTracer(scene).render(scene.cameras.front(), {.width = kWidth, .height = kHeight, .spp = 16});
  for (const char* graph : {"direct", "clustered_voxel_pixels"}) {
    PipelineOptions options = optionsOf(graph, 16);
    if (options.graph == "direct") options.settings.clear();
    options.outputs = {"composite.color"};
    Pipeline p(device(), scene, options);
    p.run();
    const image::Image picture = p.picture("composite.color");
    for (size_t i = 0; i < picture.data.size(); ++i) ASSERT_NEAR(picture.data[i], truth.color.mean.data[i], 0.02f) << i;
  }
}

// The node in a graph traces the same scene, read back from the device.
TEST_F(Sky, ThePathTracersNodeHasTheImageToo) {
  scene::Scene scene = courtUnder(glm::vec3(0.1f));
  scene.sky = scene::loadSky("builtin:clear?turn=30");
  PipelineOptions options = optionsOf("reference", 0);
  options.settings = {{"path_trace.spp", "4"}};
  options.outputs = {"path_trace.color"};
  options.width = 32;
  options.height = 18;
  Pipeline p(device(), scene, options);
  p.run();
  const reference::Images truth = reference::PathTracer(scene).render(scene.cameras.front(), {.width = 32, .height = 18, .spp = 4});
  const image::Image picture = p.picture("path_trace.color");
  double sum = 0, expected = 0;
  for (const float value : picture.data) sum += static_cast<double>(value);
  for (const float value : truth.color.mean.data) expected += static_cast<double>(value);
  EXPECT_NEAR(sum / expected, 1, 1e-4);
}

/// Meshes that emit, by samples with shadow maps (few of them) and by rays (a tenth of all surface or more).
TEST_F(Sky, SlowEmissiveMeshesLightWithoutNoise) {
  const scene::Scene lamp = scene::loadScene("builtin:cornell");
  scene::Scene walls = courtUnder(glm::vec3(0.f));
  for (size_t m = 0; m < walls.materials.size(); ++m) {
    if (walls.materialNames[m] == "grey") continue;
    walls.materials[m].emission = glm::vec3(0.5f, 1.f, 0.7f);
    walls.materials[m].flags |= shared::kMaterialEmissive;
  }
  EXPECT_FALSE(lamp.traits().emittersByRays);
  EXPECT_TRUE(walls.traits().emittersByRays);
  const scene::Scene* const both[] = {&lamp, &walls};
  for (const scene::Scene* scene : both) {
    const reference::Images truth = traceTruth(*scene);
    for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
      // All light of the walls comes by rays: at the 16 a face of the pixels' graph their draw alone is worth 2 %.
      const Quality q = measure(*scene, truth, graph, scene == &lamp ? "lamp" : "emissive walls", scene == &lamp ? 0 : 64);
      EXPECT_NEAR(q.direct.bias, 1, 0.02);
      EXPECT_NEAR(q.indirect.bias, 1, 0.02);
    }
  }
}

}  // namespace
}  // namespace radivox
