// Sky light in whole pictures: what of it bounces, against the path tracer and closed forms.
#include <gtest/gtest.h>

#include <cstdio>

#include "engine/scene/builtin.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/oracles/truth.h"
#include "tests/reference/reference_fixture.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

constexpr uint32_t kWidth = 160, kHeight = 90;

PipelineOptions optionsOf(const std::string& graph, uint32_t resolution) {
  PipelineOptions options;
  options.graph = graph;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}};
  options.outputs = {"composite.color", "composite.irradiance_direct", "composite.indirect_radiance"};
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
  Quality measure(const scene::Scene& scene, const reference::Images& truth, const std::string& graph, const char* what) {
    Pipeline p(device(), scene, optionsOf(graph, 64));
    p.run();
    Quality q;
    q.direct = oracles::compareToTruth(truth.irradianceDirect.mean, p.picture("composite.irradiance_direct"), truth.albedo.mean);
    q.indirect = oracles::compareToTruth(truth.indirect.mean, p.picture("composite.indirect_radiance"), truth.albedo.mean);
    std::printf("%s, %s: direct %.2f dB (bias %.4f), indirect %.2f dB (bias %.4f)\n", what, graph.c_str(), q.direct.psnr, q.direct.bias,
                q.indirect.psnr, q.indirect.bias);
    return q;
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
  const reference::Images truth = traceTruth(scene);
  for (const char* graph : {"clustered_voxel", "clustered_voxel_pixels"}) {
    const Quality q = measure(scene, truth, graph, "even sky");
    EXPECT_NEAR(q.direct.bias, 1, 0.02);
    EXPECT_NEAR(q.indirect.bias, 1, 0.03);
  }
}

// Direct light alone has the sky's, too.
TEST_F(Sky, ZeroBouncesKeepTheSkysLight) {
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
TEST_F(Sky, ConvexBodyUnderAnEvenSky) {
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
TEST_F(Sky, AnotherSkyLeavesVisibilityAsItIs) {
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

}  // namespace
}  // namespace radivox
