// reference.path_trace in a graph: the same picture as without one, from device buffers alone.
#include "engine/scene/gpu_scene.h"
#include "modules/modules.h"
#include "modules/reference/scene_from_buffers.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"
#include "tests/reference/reference_fixture.h"

namespace radivox::reference_test {
namespace {

class ReferenceNode : public oracles::GpuTest {
 protected:
  static constexpr uint32_t kWidth = 32, kHeight = 24;
  static oracles::PipelineOptions options(std::vector<std::string> outputs) {
    oracles::PipelineOptions all;
    all.graph = "reference";
    all.outputs = std::move(outputs);
    all.width = kWidth;
    all.height = kHeight;
    all.bounces = 2;
    all.settings = {{"path_trace.spp", "16"}, {"path_trace.seed", "3"}};
    return all;
  }
  static reference::Images traceOnHost(const scene::Scene& scene) {
    return reference::PathTracer(scene).render(scene.cameras[0], {.width = kWidth, .height = kHeight, .bounces = 2, .spp = 16, .seed = 3});
  }
  /// The same random paths, but for the last digits of camera and lights: here and there one meets another surface.
  static void expectAlike(const image::Image& a, const image::Image& b, const std::string& what) {
    ASSERT_EQ(a.data.size(), b.data.size());
    size_t differentCount = 0;
    for (size_t i = 0; i < a.data.size(); ++i)
      differentCount += std::abs(a.data[i] - b.data[i]) > 1e-3f * std::abs(b.data[i]) + 1e-5f ? 1 : 0;
    EXPECT_LT(differentCount, a.data.size() / 20) << what;
    EXPECT_NEAR(image::meanOf(a), image::meanOf(b), 2e-3 * image::meanOf(b)) << what;
  }
};

TEST_F(ReferenceNode, SamePictureAsWithoutAGraph) {
  scene::Scene scene = scene::loadScene("builtin:cornell_point");
  scene.lights.push_back(scene.lights[0]);
  scene::PunctualLight& spot = scene.lights.back();
  spot.type = shared::kLightSpot;
  spot.direction = glm::normalize(glm::vec3(0.4f, -1.f, 0.2f));
  spot.range = 9.f;
  spot.innerConeAngle = 0.2f;
  spot.outerConeAngle = 0.6f;
  const auto lamp = scene::loadScene("builtin:cornell");
  for (const scene::Scene& each : {scene, lamp, scene::loadScene("builtin:atrium?triangles=3000")}) {
    oracles::Pipeline pipeline(device(), each,
                               options({"path_trace.color", "path_trace.direct", "path_trace.indirect", "path_trace.irradiance_direct",
                                        "path_trace.irradiance", "path_trace.albedo", "path_trace.color_variance"}));
    pipeline.run();
    const reference::Images exact = traceOnHost(each);
    expectAlike(pipeline.picture("path_trace.color"), exact.color.mean, "color");
    expectAlike(pipeline.picture("path_trace.direct"), exact.direct.mean, "direct");
    expectAlike(pipeline.picture("path_trace.indirect"), exact.indirect.mean, "indirect");
    expectAlike(pipeline.picture("path_trace.irradiance_direct"), exact.irradianceDirect.mean, "irradiance_direct");
    expectAlike(pipeline.picture("path_trace.irradiance"), exact.irradianceIndirect.mean, "irradiance");
    expectAlike(pipeline.picture("path_trace.albedo"), exact.albedo.mean, "albedo");
    EXPECT_NEAR(image::meanOf(pipeline.picture("path_trace.color_variance")), image::meanOf(exact.color.variance),
                0.05 * image::meanOf(exact.color.variance));
    EXPECT_EQ(pipeline.figure("path_trace", "samples"), 16);
  }
}

TEST_F(ReferenceNode, TexturesComeOverTheirAddresses) {
  scene::MeshBuilder mesh("sheet");
  const uint32_t paint = mesh.addMaterial("paint", glm::vec3(0.9f));
  mesh.addQuad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, paint);
  mesh.addSun({0.2, -1, 0.1}, glm::vec3(2.f));
  mesh.addCamera("c", {0, 2, 0.5}, {0, 0, 0}, 0.8);
  scene::Scene scene = mesh.finish(1.0, glm::dvec3(0));
  for (shared::Vertex& vertex : scene.vertices) vertex.uvBase = glm::vec2(vertex.position.x, vertex.position.z) * 1.7f;
  for (const uint32_t wrap : {shared::kWrapRepeat, shared::kWrapMirror}) {
    scene::TextureImage image;
    image.width = 5;
    image.height = 3;
    image.wrapU = wrap;
    image.nearest = wrap == shared::kWrapMirror;
    for (int i = 0; i < 15; ++i) {
      for (const int value : {i * 17, 255 - i * 9, (i * 37) % 256, 255}) image.rgba.push_back(static_cast<uint8_t>(value));
    }
    scene.textures.push_back(image);
  }
  for (uint32_t texture = 0; texture < 2; ++texture) {
    scene.materials[scene.triangleMaterials[0]].baseTexture = texture;
    oracles::Pipeline pipeline(device(), scene, options({"path_trace.albedo", "path_trace.color"}));
    pipeline.run();
    const reference::Images exact = traceOnHost(scene);
    expectAlike(pipeline.picture("path_trace.albedo"), exact.albedo.mean, "albedo");
    expectAlike(pipeline.picture("path_trace.color"), exact.color.mean, "color");
  }
}

TEST_F(ReferenceNode, RunsAgainOnlyWhenSomethingChanged) {
  scene::Scene scene = scene::loadScene("builtin:cornell");
  oracles::Pipeline pipeline(device(), scene, options({"path_trace.color"}));
  pipeline.run();
  pipeline.run();
  EXPECT_EQ(pipeline.runCount("path_trace"), 1u);
  scene.cameras[0].position.z -= 0.5f;
  pipeline.setCamera(scene.cameras[0]);
  pipeline.run();
  EXPECT_EQ(pipeline.runCount("path_trace"), 2u);
  expectAlike(pipeline.picture("path_trace.color"), traceOnHost(scene).color.mean, "from elsewhere");
  scene.skyRadiance = glm::vec3(1.f);
  pipeline.setLights(scene);
  pipeline.run();
  EXPECT_EQ(pipeline.runCount("path_trace"), 3u);
  expectAlike(pipeline.picture("path_trace.color"), traceOnHost(scene).color.mean, "other light");
}

TEST_F(ReferenceNode, StandsInForAnyMethod) {
  // In the place of direct light and of a method: composite makes of its irradiances the picture that it makes itself, but for edges.
  const scene::Scene scene = scene::loadScene("builtin:cornell");
  plugin::Registry registry;
  registerModules(registry);
  graph::Graph graph = graph::Graph::fromJson(R"({
    "help": "test",
    "nodes": {"gbuffer": {"type": "frame.gbuffer"}, "path_trace": {"type": "reference.path_trace", "params": {"spp": 16}},
              "composite": {"type": "frame.composite"}},
    "edges": [["gbuffer.albedo", "composite.albedo"], ["gbuffer.emission", "composite.emission"],
              ["path_trace.irradiance_direct", "composite.irradiance"], ["path_trace.irradiance", "composite.indirect"]],
    "outputs": ["composite.color", "path_trace.color"]})",
                                              "test", registry);
  scene::GpuScene gpuScene(device(), scene);
  gpuScene.setCamera(scene.cameras[0], kWidth, kHeight);
  const scene::Request request{.width = kWidth, .height = kHeight};
  const scene::Traits traits = scene::traitsFor(scene, {});
  graph::Plan plan = graph::compile(graph, {traits, request, device().capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(device(), graph, std::move(plan), traits, request, gpuScene.counts());
  gpuScene.importInto(executor);
  executor.run();
  const auto pixels = [&](const char* port) {
    const auto raw = gpu::download(device(), *executor.findImage(port));
    std::vector<glm::vec4> out(raw.size() / sizeof(glm::vec4));
    std::memcpy(out.data(), raw.data(), raw.size());
    return out;
  };
  const auto composed = pixels("composite.color"), traced = pixels("path_trace.color");
  size_t alike = 0;
  for (size_t i = 0; i < traced.size(); ++i) alike += glm::length(composed[i] - traced[i]) < 1e-3f * glm::length(traced[i]) ? 1 : 0;
  EXPECT_GT(alike, traced.size() / 2) << "of " << traced.size();
}

TEST(ReferenceCamera, IsFoundAgainInItsMatrices) {
  for (const bool orthographic : {false, true}) {
    scene::CameraDescription camera;
    camera.position = {12.f, -3.f, 5.f};
    camera.orientation = glm::normalize(glm::quat(0.3f, 0.5f, -0.2f, 0.7f));
    camera.orthographic = orthographic;
    camera.yfov = 0.9f;
    camera.ymag = 2.5f;
    camera.znear = 0.02f;
    camera.zfar = 80.f;
    const scene::CameraDescription found = reference::describeCamera(scene::makeCamera(camera, 320, 200));
    EXPECT_EQ(found.orthographic, orthographic);
    EXPECT_NEAR(std::abs(glm::dot(found.orientation, camera.orientation)), 1.f, 1e-6f);
    EXPECT_EQ(found.position, camera.position);
    if (orthographic) {
      EXPECT_NEAR(found.ymag, 2.5f, 1e-5f);
      EXPECT_NEAR(found.znear, 0.02f, 1e-3f);
      EXPECT_NEAR(found.zfar, 80.f, 1e-3f);
    } else {
      EXPECT_NEAR(found.yfov, 0.9f, 1e-6f);
      EXPECT_NEAR(found.znear, 0.02f, 1e-7f);
    }
  }
}

}  // namespace
}  // namespace radivox::reference_test
