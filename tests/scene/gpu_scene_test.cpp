// The scene on the device: what arrives, what is versioned, what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/graph/executor.h"
#include "engine/scene/builtin.h"
#include "engine/scene/gpu_scene.h"
#include "engine/scene/texture.h"
#include "shaders/shared/sky.h"
#include "tests/gpu/expect_error.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox::tests {
namespace {

using scene::GpuScene;
using scene::Scene;

/// Takes the imports of a GpuScene, as a node would see them.
class SinkNode : public graph::Node {
 public:
  explicit SinkNode(std::string read) : read_(std::move(read)) {}
  std::string_view type() const override { return "test.sink"; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override {
    d.read(read_, "what the scene holds", graph::UseTransfer);
    d.write("copy", graph::Shape::buffer(1, 1), "nothing", graph::UseTransfer);
  }
  void record(graph::RecordContext& context) override {
    ++runCount;
    const gpu::Buffer& buffer = context.buffer(read_);
    handle = buffer.handle();
    bytes = buffer.bytes();
    context.commands().fill(context.buffer("copy"), 0);
  }
  int runCount = 0;
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceSize bytes = 0;

 private:
  std::string read_;
  params::Table table_;
};

class GpuSceneTest : public oracles::GpuTest {
 protected:
  /// Contents of an import, through a graph that reads it.
  template <class T>
  std::vector<T> read(const GpuScene& gpuScene, const Scene& s, const std::string& import, size_t count) {
    graph::Graph graph;
    auto& sink = static_cast<ReaderNode&>(graph.add("reader", std::make_unique<ReaderNode>(import, count * sizeof(T))));
    graph.output("reader.copy");
    const auto traits = s.traits();
    const scene::Request request;
    graph::Plan plan = graph::compile(graph, {traits, request, device().capabilities(), gpuScene.imports(), gpuScene.counts()});
    graph::Executor executor(device(), graph, std::move(plan), traits, request, gpuScene.counts());
    gpuScene.importInto(executor);
    executor.run();
    EXPECT_GE(sink.bytes, count * sizeof(T));
    return gpu::downloadAs<T>(device(), *executor.findBuffer("reader.copy"), count);
  }

  class ReaderNode : public graph::Node {
   public:
    ReaderNode(std::string import, size_t size) : import_(std::move(import)), size_(size) {}
    std::string_view type() const override { return "test.reader"; }
    params::Table& params() override { return table_; }
    void declare(graph::Declaration& d) override {
      d.read(import_, "what the scene holds", graph::UseTransfer);
      d.write("copy", graph::Shape::buffer(1, size_), "the same", graph::UseTransfer);
    }
    void record(graph::RecordContext& context) override {
      bytes = context.buffer(import_).bytes();
      context.commands().copy(context.buffer(import_), context.buffer("copy"), size_);
    }
    VkDeviceSize bytes = 0;

   private:
    std::string import_;
    size_t size_;
    params::Table table_;
  };
};

template <class T>
void expectSameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

TEST_F(GpuSceneTest, EverythingArrives) {
  Scene s = scene::loadScene("builtin:cornell");
  s.skyRadiance = {0.1f, 0.2f, 0.3f};
  GpuScene gpuScene(device(), s);
  gpuScene.setCamera(s.cameras[0], 64, 48);
  const auto setup = setUpLights(s, scene::LightOptions());
  expectSameBytes(read<shared::Vertex>(gpuScene, s, "scene.vertices", s.vertices.size()), s.vertices);
  expectSameBytes(read<uint32_t>(gpuScene, s, "scene.indices", s.indices.size()), s.indices);
  expectSameBytes(read<uint32_t>(gpuScene, s, "scene.triangle_materials", s.triangleMaterials.size()), s.triangleMaterials);
  expectSameBytes(read<shared::Material>(gpuScene, s, "scene.materials", s.materials.size()), s.materials);
  expectSameBytes(read<shared::Light>(gpuScene, s, "scene.lights", setup.lights.size()), setup.lights);
  expectSameBytes(read<shared::ShadowView>(gpuScene, s, "scene.shadow_views", setup.views.size()), setup.views);
  expectSameBytes(read<shared::EmissiveTriangle>(gpuScene, s, "scene.emissive_triangles", 2), setup.emissive);
  const auto camera = read<shared::Camera>(gpuScene, s, "view.camera", 1);
  const shared::Camera expected = scene::makeCamera(s.cameras[0], 64, 48);
  EXPECT_EQ(camera[0].viewProjection, expected.viewProjection);
  EXPECT_EQ(camera[0].width, 64u);
  const auto info = read<shared::SceneInfo>(gpuScene, s, "scene.info", 1)[0];
  EXPECT_EQ(info.triangleCount, s.triangleCount());
  EXPECT_EQ(info.lightCount, 32u);
  EXPECT_EQ(info.skyRadiance, s.skyRadiance);
  EXPECT_EQ(info.materialCount, 4u);
  EXPECT_EQ(info.emissiveTriangleCount, 2u);
  EXPECT_EQ(info.shadowViewCount, 160u);
  EXPECT_EQ(info.emitterSampleCount, 32u);
  EXPECT_NEAR(info.emissiveArea, 1.43f, 1e-5f);
  EXPECT_EQ(info.boundsMax, s.traits().boundsMax);
}

TEST_F(GpuSceneTest, TheSkyIsAnImageAndItsSunALight) {
  Scene s = scene::loadScene("builtin:plane", "builtin:clear");
  const auto lamps = static_cast<uint32_t>(s.lights.size());
  GpuScene gpuScene(device(), s);
  EXPECT_EQ(gpuScene.counts().at("sky_texels"), shared::kSkyFirstTexel + 512u * 256u);
  EXPECT_EQ(gpuScene.counts().at("lights"), lamps + 1u);
  const auto info = read<shared::SceneInfo>(gpuScene, s, "scene.info", 1)[0];
  EXPECT_EQ(info.skyWidth, 512u);
  EXPECT_EQ(info.skyHeight, 256u);
  const auto lights = read<shared::Light>(gpuScene, s, "scene.lights", lamps + 1);
  EXPECT_EQ(lights[lamps].triangle, shared::kSkySun);
  EXPECT_EQ(lights[lamps].type, shared::kLightDirectional);
  // Another sky, without loading anything else anew.
  s.sky = nullptr;
  s.skyRadiance = glm::vec3(1.f);
  gpuScene.setLights(s);
  EXPECT_EQ(gpuScene.counts().at("sky_texels"), 0u);
  EXPECT_EQ(gpuScene.counts().at("lights"), lamps);
  EXPECT_EQ(read<shared::SceneInfo>(gpuScene, s, "scene.info", 1)[0].skyWidth, 0u);
}

TEST_F(GpuSceneTest, CountsNameWhatThereIs) {
  const Scene s = scene::loadScene("builtin:cornell_point");
  GpuScene gpuScene(device(), s);
  gpuScene.setCamera(s.cameras[0], 640, 360);
  const auto counts = gpuScene.counts();
  const graph::Counts expected = {{"triangles", 34},
                                  {"vertices", 68},
                                  {"materials", 3},
                                  {"textures", 0},
                                  {"lights", 1},
                                  {"shadow_views", 6},
                                  {"shadow_resolution", 2048},
                                  {"shadow_layers", 2},
                                  {"emitter_samples", 0},
                                  {"emissive_triangles", 0},
                                  {"sky_texels", 0},
                                  {"width", 640},
                                  {"height", 360}};
  EXPECT_EQ(counts, expected);
  const auto shapes = describeShapes(s, scene::LightOptions(), 640, 360);  // the same without a device
  EXPECT_EQ(shapes.counts, expected);
  for (const auto& import : gpuScene.imports()) EXPECT_TRUE(import.shape.elements.evaluate(counts).has_value()) << import.name;
}

TEST_F(GpuSceneTest, OnlyWhatChangedRunsAgain) {
  Scene s = scene::loadScene("builtin:cornell_point");
  GpuScene gpuScene(device(), s);
  graph::Graph graph;
  auto& geometry = static_cast<SinkNode&>(graph.add("geometry", std::make_unique<SinkNode>("scene.vertices")));
  auto& lights = static_cast<SinkNode&>(graph.add("lights", std::make_unique<SinkNode>("scene.lights")));
  auto& camera = static_cast<SinkNode&>(graph.add("camera", std::make_unique<SinkNode>("view.camera")));
  for (const char* name : {"geometry.copy", "lights.copy", "camera.copy"}) graph.output(name);
  const auto traits = s.traits();
  const scene::Request request;
  graph::Plan plan = graph::compile(graph, {traits, request, device().capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(device(), graph, std::move(plan), traits, request, gpuScene.counts());
  const auto expectRuns = [&](int g, int l, int c) {
    gpuScene.importInto(executor);
    executor.run();
    EXPECT_EQ(geometry.runCount, g);
    EXPECT_EQ(lights.runCount, l);
    EXPECT_EQ(camera.runCount, c);
  };
  expectRuns(1, 1, 1);
  expectRuns(1, 1, 1);
  s.lights[0].intensity *= 2.f;
  gpuScene.setLights(s);
  expectRuns(1, 2, 1);
  gpuScene.setCamera(s.cameras[0], 32, 32);
  expectRuns(1, 2, 2);
}

TEST_F(GpuSceneTest, EmptySceneHasValidBuffers) {
  const Scene s = scene::loadScene("builtin:empty");
  GpuScene gpuScene(device(), s);
  EXPECT_EQ(gpuScene.counts().at("triangles"), 0u);
  EXPECT_EQ(gpuScene.counts().at("shadow_views"), 0u);
  EXPECT_EQ(read<shared::SceneInfo>(gpuScene, s, "scene.info", 1)[0].triangleCount, 0u);
  EXPECT_EQ(read<uint32_t>(gpuScene, s, "scene.textures", 4).size(), 4u);  // a dummy of 16 bytes
}

TEST_F(GpuSceneTest, RefusesScenesBeyondTheBindingRange) {
  if (device().capabilities().maxStorageBufferRange > (256u << 20)) GTEST_SKIP() << "this device binds more than a test should allocate";
  Scene s = scene::loadScene("builtin:box");
  s.vertices.resize(device().capabilities().maxStorageBufferRange / sizeof(shared::Vertex) + 1);
  expectError(catchError([&] { GpuScene gpuScene(device(), s); }), ErrorCode::OutOfMemory, "about 11 triangles fit: simplify the scene");
}

/// Whichever allocation fails, nothing stays behind (the fixture looks) and the error says what it was.
TEST_F(GpuSceneTest, EveryFailedAllocationIsClean) {
  const Scene s = scene::loadScene("builtin:cornell");
  uint32_t failures = 0;
  for (uint32_t n = 1; n < 200; ++n) {
    device().failAfter(n);
    try {
      GpuScene gpuScene(device(), s);
      device().failAfter(0);
      break;
    } catch (const Error& error) {
      device().failAfter(0);
      ++failures;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GE(failures, 10u);  // one for each buffer at least
  EXPECT_LT(failures, 199u);
}

TEST_F(GpuSceneTest, TexturesReadAsOnTheHost) {
  Scene s = scene::loadScene("builtin:box");
  uint32_t random = 7;
  const auto next = [&] {
    random = random * 1664525u + 1013904223u;
    return random >> 8;
  };
  const std::pair<uint32_t, uint32_t> sizes[] = {{1, 1}, {16, 16}, {13, 7}, {64, 2}, {5, 1}, {31, 33}};
  for (uint32_t i = 0; i < 12; ++i) {
    scene::TextureImage image;
    image.width = sizes[i % 6].first;
    image.height = sizes[i % 6].second;
    for (uint32_t k = 0; k < image.width * image.height * 4; ++k) image.rgba.push_back(static_cast<uint8_t>(next()));
    image.wrapU = i % 3;
    image.wrapV = (i / 2) % 3;
    image.nearest = i % 4 == 3;
    image.srgb = i % 5 != 4;
    s.textures.push_back(image);
  }
  GpuScene gpuScene(device(), s);
  const auto table = read<shared::Texture>(gpuScene, s, "scene.textures", s.textures.size());
  gpu::Buffer tableBuffer(device(), "table", table.size() * sizeof(shared::Texture));
  gpu::upload(device(), tableBuffer, table);
  gpu::Pipeline pipeline(device(), gpu::ComputePipelineInfo{.shader = "scene/test_texture.comp",
                                                            .bindings = std::vector<gpu::BindingType>(3, gpu::BindingType::StorageBuffer),
                                                            .pushConstantBytes = 8});
  for (uint32_t i = 0; i < s.textures.size(); ++i) {
    SCOPED_TRACE(i);
    const scene::MipChain chain = scene::buildMipChain(s.textures[i]);
    std::vector<glm::vec3> places;
    for (int k = 0; k < 500; ++k) {
      const auto u = static_cast<float>(next() % 60000) / 10000.f - 3.f, v = static_cast<float>(next() % 60000) / 10000.f - 3.f;
      places.emplace_back(u, v, k % 2 == 0 ? 0.f : static_cast<float>(next() % 100) / 100.f * static_cast<float>(chain.levelCount));
    }
    gpu::Buffer placeBuffer(device(), "places", places.size() * sizeof(glm::vec3)),
        colors(device(), "colors", places.size() * sizeof(glm::vec4));
    gpu::upload(device(), placeBuffer, places);
    run([&](gpu::Commands& commands) {
      commands.bind(pipeline, {tableBuffer, placeBuffer, colors});
      const uint32_t push[2] = {static_cast<uint32_t>(places.size()), i};
      commands.push(push);
      commands.dispatchItems(places.size(), 64);
    });
    const auto seen = gpu::downloadAs<glm::vec4>(device(), colors, places.size());
    // Levels as images of their own, read by the host's lookup.
    std::vector<scene::TextureImage> levels;
    size_t at = 0;
    for (uint32_t l = 0; l < chain.levelCount; ++l) {
      scene::TextureImage level = s.textures[i];
      level.width = std::max(level.width >> l, 1u);
      level.height = std::max(level.height >> l, 1u);
      level.rgba.resize(size_t{level.width} * level.height * 4);
      std::memcpy(level.rgba.data(), chain.texels.data() + at, level.rgba.size());
      at += size_t{level.width} * level.height;
      levels.push_back(level);
    }
    for (size_t k = 0; k < places.size(); ++k) {
      const glm::vec2 uv(places[k]);
      if (s.textures[i].nearest) {  // a place on a border may fall on either side
        const glm::vec2 t = uv * glm::vec2(s.textures[i].width, s.textures[i].height) * 8.f;
        if (std::abs(t.x - std::round(t.x)) < 1e-3f || std::abs(t.y - std::round(t.y)) < 1e-3f || places[k].z != 0.f) continue;
      }
      const float level = std::min(places[k].z, static_cast<float>(chain.levelCount - 1));
      const auto fine = static_cast<size_t>(level);
      glm::vec4 expected = scene::sampleTexture(levels[fine], uv);
      if (fine + 1 < levels.size())
        expected = glm::mix(expected, scene::sampleTexture(levels[fine + 1], uv), level - static_cast<float>(fine));
      for (glm::length_t c = 0; c < 4; ++c)
        EXPECT_NEAR(seen[k][c], expected[c], 2e-4f) << k << ": " << uv.x << " " << uv.y << " " << places[k].z;
    }
  }
}

/// Structs are the same text in C++ and GLSL; scalar layout leaves no room between members.
TEST(SharedLayoutTest, SizesAreSumsOfMembers) {
  EXPECT_EQ(sizeof(shared::Vertex), 40u);
  EXPECT_EQ(sizeof(shared::Material), 44u);
  EXPECT_EQ(sizeof(shared::Texture), 32u);
  EXPECT_EQ(sizeof(shared::Light), 64u);
  EXPECT_EQ(sizeof(shared::ShadowView), 164u);
  EXPECT_EQ(sizeof(shared::EmissiveTriangle), 24u);
  EXPECT_EQ(sizeof(shared::Camera), 168u);
  EXPECT_EQ(sizeof(shared::SceneInfo), 76u);
}

}  // namespace
}  // namespace radivox::tests
