// radivox.h as its users see it: results, errors, versions of structs, lifetimes; pictures against those of the engine's own classes
// elsewhere (install.SlowC compares with radivox render).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

#include "bindings/c/radivox.h"
#include "engine/image/image.h"
#include "engine/scene/scene.h"

namespace {

namespace fs = std::filesystem;

template <class T>
T make() {
  T value{};
  value.structSize = sizeof value;
  return value;
}

std::string readGraph(const std::string& name) {
  std::ifstream file(RADIVOX_SOURCE_DIR "/samples/graphs/" + name + ".json");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

#define EXPECT_FAILS(result, call, words)                                                            \
  do {                                                                                               \
    EXPECT_EQ(call, result) << radivoxLastError();                                                   \
    EXPECT_NE(std::string(radivoxLastError()).find(words), std::string::npos) << radivoxLastError(); \
    EXPECT_EQ(std::string(radivoxLastError()).find('\n'), std::string::npos) << "not one line";      \
  } while (false)
#define ASSERT_WORKS(call) ASSERT_EQ(call, RADIVOX_OK) << radivoxLastError()

class CInterface : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "radivox_c_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    radivoxDestroyRenderer(renderer_);
    radivoxDestroyGraph(graph_);
    radivoxDestroyScene(scene_);
    radivoxDestroyDevice(device_);
    fs::remove_all(folder_);
  }

  void makeGraph(const std::string& json) {
    auto info = make<RadivoxGraphInfo>();
    info.json = json.c_str();
    ASSERT_WORKS(radivoxCreateGraph(&info, &graph_));
  }
  /// Cornell, 32 × 24, direct light: a few pipelines only.
  void makeRenderer() {
    auto deviceInfo = make<RadivoxDeviceInfo>();
    deviceInfo.validation = VK_TRUE;
    ASSERT_WORKS(radivoxCreateDevice(&deviceInfo, &device_));
    if (scene_ == nullptr) {
      ASSERT_WORKS(radivoxLoadScene("builtin:cornell_point", &scene_));
    }
    makeGraph(readGraph("direct"));
    ASSERT_WORKS(radivoxCreateRenderer(&info(), &renderer_));
  }
  RadivoxRendererInfo& info() {
    info_ = make<RadivoxRendererInfo>();
    info_.width = 32;
    info_.height = 24;
    info_.bounces = RADIVOX_ALL_BOUNCES;
    info_.device = device_;
    info_.scene = scene_;
    info_.graph = graph_;
    return info_;
  }
  std::vector<float> picture() {
    const std::string file = (folder_ / "a.exr").string();
    EXPECT_EQ(radivoxWritePicture(renderer_, "composite.color", file.c_str()), RADIVOX_OK) << radivoxLastError();
    return radivox::image::readExr(file).at(0).image.data;
  }
  void run() { ASSERT_WORKS(radivoxRun(renderer_, nullptr, nullptr)); }

  fs::path folder_;
  RadivoxDevice* device_ = nullptr;
  RadivoxScene* scene_ = nullptr;
  RadivoxGraph* graph_ = nullptr;
  RadivoxRenderer* renderer_ = nullptr;
  RadivoxRendererInfo info_{};
};

TEST_F(CInterface, NullsAreErrorsThatNameTheArgument) {
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateDevice(nullptr, nullptr), "device is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxLoadScene(nullptr, &scene_), "file is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateGraph(nullptr, &graph_), "info is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxRun(nullptr, nullptr, nullptr), "renderer is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxSetParameter(nullptr, "a.b", "1"), "graph is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateNeeds(VK_NULL_HANDLE, nullptr), "needs is NULL");
  auto adopt = make<RadivoxAdoptInfo>();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxAdoptDevice(&adopt, &device_), "info->instance is NULL");
  EXPECT_EQ(radivoxIsReadyToRecord(nullptr), VK_FALSE);
  EXPECT_EQ(radivoxCameraCount(nullptr) + radivoxLightCount(nullptr) + radivoxParameterCount(nullptr) + radivoxNodeCount(nullptr), 0u);
  EXPECT_EQ(device_, nullptr) << "a failed call writes nothing";
  radivoxDestroyDevice(nullptr);
  radivoxDestroyScene(nullptr);
  radivoxDestroyGraph(nullptr);
  radivoxDestroyRenderer(nullptr);
  radivoxDestroyNeeds(nullptr);
}

TEST_F(CInterface, StructsOfOtherVersions) {
  RadivoxGraphInfo info{};
  info.json = "{}";
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateGraph(&info, &graph_), "info->structSize is not set");
  struct Later {
    RadivoxGraphInfo known;
    uint64_t added = 0;
  } later;
  const std::string json = readGraph("direct");
  later.known = RadivoxGraphInfo{};
  later.known.structSize = sizeof later;
  later.known.json = json.c_str();
  later.added = 1;
  EXPECT_FAILS(RADIVOX_UNSUPPORTED, radivoxCreateGraph(&later.known, &graph_), "later library");
  later.added = 0;  // what this library does not know is not asked for
  ASSERT_WORKS(radivoxCreateGraph(&later.known, &graph_));
  radivoxDestroyGraph(graph_);
  // A program of before `name` and `modules` were there.
  auto earlier = make<RadivoxGraphInfo>();
  earlier.json = json.c_str();
  earlier.structSize = offsetof(RadivoxGraphInfo, name);
  earlier.name = reinterpret_cast<const char*>(1);
  ASSERT_WORKS(radivoxCreateGraph(&earlier, &graph_));
  // And what is written ends where the caller's struct does.
  ASSERT_WORKS(radivoxLoadScene("builtin:cornell_point", &scene_));
  auto camera = make<RadivoxCamera>();
  camera.structSize = offsetof(RadivoxCamera, nearPlane);
  camera.nearPlane = 77;
  ASSERT_WORKS(radivoxGetCamera(scene_, 0, &camera));
  EXPECT_EQ(camera.nearPlane, 77);
  EXPECT_EQ(camera.structSize, offsetof(RadivoxCamera, nearPlane));
  EXPECT_GT(camera.verticalAngle, 0.f);
}

TEST_F(CInterface, ErrorsAreAThreadsOwn) {
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxLoadScene("nowhere.glb", &scene_), "nowhere.glb");
  std::string other = "not run";
  std::thread([&] { other = radivoxLastError(); }).join();
  EXPECT_EQ(other, "");
  EXPECT_NE(std::string(radivoxLastError()).find("nowhere.glb"), std::string::npos);
}

TEST_F(CInterface, GraphsAndParameters) {
  auto info = make<RadivoxGraphInfo>();
  info.json = R"({"nodes": {"a": {"type": "frame.gbufer"}, "b": {}}})";
  info.name = "mine.json";
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateGraph(&info, &graph_), "did you mean frame.gbuffer");
  EXPECT_NE(std::string(radivoxLastError()).find("mine.json"), std::string::npos);
  makeGraph(readGraph("clustered_voxel"));
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxSetParameter(graph_, "voxelize.resolutoin", "64"), "did you mean resolution");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxSetParameter(graph_, "voxelize.resolution", "-1"), "voxelize.resolution");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxReplaceByImports(graph_, "gbufer", "host"), "did you mean gbuffer");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxReplaceByImports(graph_, "gbuffer", "direct"), "that no node has");
  ASSERT_WORKS(radivoxApplyPreset(graph_, R"({"set": {"voxelize.resolution": 48}})", nullptr));
  const char* value = nullptr;
  ASSERT_WORKS(radivoxGetParameter(graph_, "voxelize.resolution", &value));
  EXPECT_STREQ(value, "48");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxGetParameter(graph_, "voxelize.resolutio", &value), "did you mean voxelize.resolution");
  bool found = false;
  for (uint32_t i = 0; i < radivoxParameterCount(graph_); ++i) {
    auto parameter = make<RadivoxParameter>();
    ASSERT_WORKS(radivoxDescribeParameter(graph_, i, &parameter));
    EXPECT_GT(std::strlen(parameter.help), 0u);
    if (std::strcmp(parameter.node, "visibility") != 0 || std::strcmp(parameter.name, "traversal") != 0) continue;
    found = true;
    EXPECT_EQ(parameter.type, static_cast<uint32_t>(RADIVOX_PARAMETER_CHOICE));
    EXPECT_STREQ(parameter.choices, "dda,bresenham");
    EXPECT_STREQ(parameter.defaultValue, "dda");
  }
  EXPECT_TRUE(found);
  auto parameter = make<RadivoxParameter>();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxDescribeParameter(graph_, 100000, &parameter), "100000");
}

#ifdef RADIVOX_WITH_VDB
TEST_F(CInterface, TextParameters) {
  makeGraph(R"({"nodes": {"file": {"type": "vdb.write"}}})");
  auto parameter = make<RadivoxParameter>();
  ASSERT_WORKS(radivoxDescribeParameter(graph_, 0, &parameter));
  EXPECT_STREQ(parameter.name, "file");
  EXPECT_EQ(parameter.type, static_cast<uint32_t>(RADIVOX_PARAMETER_TEXT));
  EXPECT_STREQ(parameter.choices, "");
  ASSERT_WORKS(radivoxSetParameter(graph_, "file.file", "hall.vdb"));
  const char* value = nullptr;
  ASSERT_WORKS(radivoxGetParameter(graph_, "file.file", &value));
  EXPECT_STREQ(value, "hall.vdb");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxSetParameter(graph_, "file.grids", "no_such"), "no_such");
}
#endif

TEST_F(CInterface, ScenesOfTheHostAreLitAsFilesAre) {
  const radivox::scene::Scene scene = radivox::scene::loadScene("builtin:cornell_point");
  std::vector<RadivoxVertex> vertices;
  for (const auto& v : scene.vertices) {
    vertices.push_back({{v.position.x, v.position.y, v.position.z}, {v.normal.x, v.normal.y, v.normal.z}, {v.uvBase.x, v.uvBase.y}});
  }
  std::vector<RadivoxMaterial> materials;
  for (const auto& m : scene.materials) {
    const uint32_t flags = (m.flags & radivox::shared::kMaterialDoubleSided) != 0 ? RADIVOX_MATERIAL_DOUBLE_SIDED : 0;
    materials.push_back({{m.albedo.x, m.albedo.y, m.albedo.z},
                         m.alpha,
                         {m.emission.x, m.emission.y, m.emission.z},
                         m.alphaCutoff,
                         RADIVOX_NO_TEXTURE,
                         RADIVOX_NO_TEXTURE,
                         flags});
  }
  const auto& l = scene.lights.at(0);
  const RadivoxLight light = {RADIVOX_LIGHT_POINT,
                              {l.position.x, l.position.y, l.position.z},
                              {0, -1, 0},
                              {l.intensity.x, l.intensity.y, l.intensity.z},
                              l.range,
                              0,
                              0};
  auto sceneInfo = make<RadivoxSceneInfo>();
  sceneInfo.vertexCount = static_cast<uint32_t>(vertices.size());
  sceneInfo.vertices = vertices.data();
  sceneInfo.indices = scene.indices.data();
  sceneInfo.triangleMaterials = scene.triangleMaterials.data();
  sceneInfo.triangleCount = static_cast<uint32_t>(scene.triangleCount());
  sceneInfo.materialCount = static_cast<uint32_t>(materials.size());
  sceneInfo.materials = materials.data();
  sceneInfo.lightCount = 1;
  sceneInfo.lights = &light;

  auto bad = vertices;
  bad[3].position[1] = std::numeric_limits<float>::quiet_NaN();
  sceneInfo.vertices = bad.data();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateScene(&sceneInfo, &scene_), "vertices[3] is not finite");
  sceneInfo.vertices = vertices.data();
  auto badIndices = scene.indices;
  badIndices[5] = 1u << 30;
  sceneInfo.indices = badIndices.data();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateScene(&sceneInfo, &scene_), "indices[5]");
  sceneInfo.indices = scene.indices.data();
  auto badMaterials = materials;
  badMaterials[0].albedoTexture = 0;
  sceneInfo.materials = badMaterials.data();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateScene(&sceneInfo, &scene_), "RADIVOX_NO_TEXTURE");
  sceneInfo.materials = materials.data();
  ASSERT_WORKS(radivoxCreateScene(&sceneInfo, &scene_));

  makeRenderer();
  RadivoxScene* loaded = nullptr;
  ASSERT_WORKS(radivoxLoadScene("builtin:cornell_point", &loaded));
  auto camera = make<RadivoxCamera>();
  ASSERT_WORKS(radivoxGetCamera(loaded, 0, &camera));
  ASSERT_WORKS(radivoxSetCamera(renderer_, &camera));
  run();
  const std::vector<float> ours = picture();
  radivoxDestroyRenderer(renderer_);
  renderer_ = nullptr;
  radivoxDestroyScene(scene_);
  scene_ = loaded;
  ASSERT_WORKS(radivoxCreateRenderer(&info(), &renderer_));  // the graph is free again
  run();
  EXPECT_EQ(picture(), ours);
  EXPECT_GT(*std::max_element(ours.begin(), ours.end()), 0.f);
}

TEST_F(CInterface, ThingsMove) {
  makeRenderer();
  run();
  const std::vector<float> before = picture();
  EXPECT_EQ(radivoxObjectCount(scene_), 0u) << "a built-in scene";
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxGetObject(scene_, 0, nullptr, nullptr, nullptr), "0 objects");
  // First a block, then everything, beyond the bounds: that plans anew.
  const float less[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.05f, 0, 0, 1},
              all[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.05f, 0, 1};
  const float mirror[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const auto count = static_cast<uint32_t>(radivox::scene::loadScene("builtin:cornell_point").vertices.size());
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxMoveVertices(scene_, 0, count, mirror), "mirror");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxMoveVertices(scene_, 1, count, less), "cannot be moved");
  ASSERT_WORKS(radivoxMoveVertices(scene_, count - 20, 20, less));
  ASSERT_WORKS(radivoxSetGeometry(renderer_));
  run();
  const std::vector<float> moved = picture();
  EXPECT_NE(moved, before);
  ASSERT_WORKS(radivoxMoveVertices(scene_, 0, count, all));
  ASSERT_WORKS(radivoxSetGeometry(renderer_));
  run();
  const std::vector<float> far = picture();
  EXPECT_NE(far, moved);
  radivoxDestroyRenderer(renderer_);
  renderer_ = nullptr;
  ASSERT_WORKS(radivoxCreateRenderer(&info(), &renderer_));
  run();
  EXPECT_EQ(picture(), far);
}

TEST_F(CInterface, LightsSizesAndParametersChangeAndComeBack) {
  makeRenderer();
  run();
  const std::vector<float> before = picture();
  // A sky more: nodes that were left out come in.
  const float day[3] = {1, 1, 1}, night[3] = {0, 0, 0};
  RadivoxLight light;
  ASSERT_WORKS(radivoxGetLight(scene_, 0, &light));
  ASSERT_WORKS(radivoxSetSceneLights(scene_, &light, 1, day));
  ASSERT_WORKS(radivoxSetLights(renderer_));
  EXPECT_EQ(radivoxIsReadyToRecord(renderer_), VK_FALSE);
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxWritePicture(renderer_, "composite.color", (folder_ / "b.exr").c_str()), "call radivoxRun first");
  run();
  EXPECT_NE(picture(), before);
  ASSERT_WORKS(radivoxSetSceneLights(scene_, &light, 1, night));
  ASSERT_WORKS(radivoxSetLights(renderer_));
  run();
  EXPECT_EQ(picture(), before);

  ASSERT_WORKS(radivoxResize(renderer_, 40, 30));
  run();
  EXPECT_EQ(picture().size(), 40u * 30 * 3);
  auto image = make<RadivoxImageInfo>();
  ASSERT_WORKS(radivoxFindImage(renderer_, "composite.color", &image));
  EXPECT_EQ(image.width, 40u);
  EXPECT_EQ(image.layout, VK_IMAGE_LAYOUT_GENERAL);
  ASSERT_WORKS(radivoxResize(renderer_, 32, 24));
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxResize(renderer_, 0, 24), "above 0");

  ASSERT_WORKS(radivoxSetParameter(graph_, "gbuffer.sides", "gltf"));
  EXPECT_EQ(radivoxIsReadyToRecord(renderer_), VK_FALSE) << "another pipeline is needed";
  run();
  ASSERT_WORKS(radivoxSetParameter(graph_, "gbuffer.sides", "both"));
  run();
  EXPECT_EQ(picture(), before);
  EXPECT_EQ(radivoxIsReadyToRecord(renderer_), VK_TRUE);
}

TEST_F(CInterface, MisuseOfARendererIsAnError) {
  makeRenderer();
  auto image = make<RadivoxImageInfo>();
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxRecord(renderer_, VK_NULL_HANDLE), "commands is NULL");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxFrameCompleted(renderer_), "without a recorded frame");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxFindImage(renderer_, "composite.color", &image), "has not been made yet");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxImportImage(renderer_, "host.position", &image, 1), "RadivoxRendererInfo::imports");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxAddOutput(graph_, "gbuffer.normal"), "planned already");
  RadivoxRenderer* second = nullptr;
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxCreateRenderer(&info(), &second), "another graph");
  int calls = 0;
  const RadivoxProgress stop = [](void* user, const char*, double) -> VkBool32 { return ++*static_cast<int*>(user) < 1; };
  EXPECT_FAILS(RADIVOX_INTERRUPTED, radivoxRun(renderer_, stop, &calls), "interrupted");
  EXPECT_GE(calls, 1);
  auto camera = make<RadivoxCamera>();
  ASSERT_WORKS(radivoxGetCamera(scene_, 0, &camera));
  ASSERT_WORKS(radivoxSetCamera(renderer_, &camera));
  run();
  const char* text = nullptr;
  ASSERT_WORKS(radivoxDescribePlan(renderer_, &text));
  EXPECT_NE(std::string(text).find("composite"), std::string::npos);
  bool ran = false;
  for (uint32_t i = 0; i < radivoxNodeCount(renderer_); ++i) {
    auto time = make<RadivoxNodeTime>();
    ASSERT_WORKS(radivoxGetNodeTime(renderer_, i, &time));
    ran = ran || (std::strcmp(time.name, "composite") == 0 && time.ranLastFrame != VK_FALSE);
  }
  EXPECT_TRUE(ran);
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxWritePicture(renderer_, "composite.color", (folder_ / "a.tiff").c_str()), ".exr or .png");
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxWritePicture(renderer_, "composite.color", (folder_ / "none/a.exr").c_str()), "none");
}

TEST_F(CInterface, HandlesGoInAnyOrder) {
  makeRenderer();
  run();
  radivoxDestroyDevice(device_);
  radivoxDestroyScene(scene_);
  radivoxDestroyGraph(graph_);
  device_ = nullptr;
  scene_ = nullptr;
  graph_ = nullptr;
  auto camera = make<RadivoxCamera>();
  camera.orientation[3] = 1;
  camera.verticalAngle = 1;
  camera.nearPlane = 0.01f;
  ASSERT_WORKS(radivoxSetCamera(renderer_, &camera));
  run();
  EXPECT_EQ(picture().size(), 32u * 24 * 3);
  camera.verticalAngle = 4;
  EXPECT_FAILS(RADIVOX_BAD_INPUT, radivoxSetCamera(renderer_, &camera), "verticalAngle");
}

}  // namespace
