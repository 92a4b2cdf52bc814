// Renders of tiny scenes through the binary: files, layers, statistics, laziness, limits, interruption.
#include <signal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/image/image.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

using nlohmann::json;

class RenderCommand : public CommandTest {
 protected:
  /// Small enough that most of the time is the start.
  std::vector<std::string> render(const std::string& scene, std::vector<std::string> more) const {
    const bool direct = std::find(more.begin(), more.end(), "direct") != more.end();
    std::vector<std::string> all = {
        "render", scene, "--size", "24x16", "--set", "lights.point_shadow_resolution=128", "--set", "lights.emitter_shadow_resolution=32"};
    if (!direct) all.insert(all.end(), {"--set", "voxelize.resolution=16", "--set", "visibility.rays=32"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expectDone(const std::vector<std::string>& arguments) const {
    const CommandResult result = runRadivox(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
  static const image::Layer* find(const std::vector<image::Layer>& layers, const std::string& name) {
    const auto found = std::find_if(layers.begin(), layers.end(), [&](const image::Layer& l) { return l.name == name; });
    return found == layers.end() ? nullptr : &*found;
  }
};

TEST_F(RenderCommand, SlowTakesASkyInPlaceOfTheScenesOwn) {
  const CommandResult clear =
      runRadivox(render("builtin:staircase", {"--sky", "builtin:clear?turn=40", "--validate", "--out", path("a.exr")}));
  EXPECT_EQ(clear.exitCode, 0);
  EXPECT_NE(clear.err.find("became a directional light"), std::string::npos) << clear.err;
  EXPECT_EQ(std::count(clear.err.begin(), clear.err.end(), '\n'), 1) << clear.err;
  // A sky of our own, written and read again; no sun in it, and nothing to say.
  image::Image sky{8, 4, 3, std::vector<float>(8 * 4 * 3, 0.5f)};
  image::writeExr(path("sky.exr"), {{"color", sky}});
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:staircase", {"--sky", path("sky.exr"), "--out", path("b.exr")})));
  EXPECT_EQ(image::readExr(path("b.exr")).front().image.at(0, 0, 0), 0.5f) << "behind the scene";
  for (const char* command : {"render", "reference", "graph", "vdb"}) {
    std::vector<std::string> arguments = {command, "builtin:box", "--sky", path("none.exr")};
    if (std::string(command) != "graph")
      arguments.insert(arguments.end(), {"--out", path(std::string(command) == "vdb" ? "c.vdb" : "c.exr")});
    expectError(arguments, 2, {"none.exr"});
  }
  expectError(render("builtin:box", {"--sky", "builtin:clear?tilt=3", "--out", path("c.exr")}), 2, {"tilt=3", "scale=X"});
}

TEST_F(RenderCommand, WritesTheLayersAskedForAndTheyAddUp) {
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--validate", "--supersample", "1", "--out", path("a.exr"), "--out",
                                                                      path("a.png"), "--stats", path("a.json"), "--aov",
                                                                      "color,direct,indirect,irradiance_direct,irradiance_indirect,albedo,"
                                                                      "normal,position,depth,face,cluster"})));
  EXPECT_EQ(files(), (std::vector<std::string>{"a.exr", "a.json", "a.png"}));
  const std::vector<image::Layer> layers = image::readExr(path("a.exr"));
  std::set<std::string> names;
  for (const image::Layer& layer : layers) {
    names.insert(layer.name);
    EXPECT_EQ(layer.image.width, 24u) << layer.name;
    EXPECT_EQ(layer.image.height, 16u) << layer.name;
    EXPECT_EQ(layer.image.channels, layer.name == "depth" || layer.name == "face" || layer.name == "cluster" ? 1u : 3u) << layer.name;
    for (const float value : layer.image.data) ASSERT_TRUE(std::isfinite(value)) << layer.name;
  }
  EXPECT_EQ(names, (std::set<std::string>{"color", "direct", "indirect", "irradiance_direct", "irradiance_indirect", "albedo", "normal",
                                          "position", "depth", "face", "cluster"}));
  // L = (direct + indirect) and each = ρE/π (of one sample a pixel; means do not multiply): the box has no emitters and no sky.
  const auto at = [&](const char* name, size_t i) { return static_cast<double>(find(layers, name)->image.data[i]); };
  double indirect = 0;
  for (size_t i = 0; i < 24 * 16 * 3; ++i) {
    const double tolerance = 1e-5 * (1.0 + at("color", i));
    EXPECT_NEAR(at("color", i), at("direct", i) + at("indirect", i), tolerance);
    EXPECT_NEAR(at("direct", i), at("albedo", i) * at("irradiance_direct", i) / M_PI, tolerance);
    EXPECT_NEAR(at("indirect", i), at("albedo", i) * at("irradiance_indirect", i) / M_PI, tolerance);
    indirect += at("indirect", i);
  }
  EXPECT_GT(indirect, 0.0);
  for (size_t i = 0; i < 24 * 16; ++i) {
    const bool surface = at("depth", i) > 0;
    const double length = std::hypot(at("normal", 3 * i), at("normal", 3 * i + 1), at("normal", 3 * i + 2));
    EXPECT_NEAR(length, surface ? 1.0 : 0.0, 1e-3);
  }
  const image::Image png = image::readPng(path("a.png"));
  EXPECT_EQ(png.width, 24u);
  EXPECT_EQ(png.height, 16u);
  EXPECT_EQ(json::parse(read("a.json")).at("validation_messages"), 0);
}

TEST_F(RenderCommand, OneAovIsWrittenAsRgb) {
  for (const char* aov : {"albedo", "depth"}) {
    ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--out", path("a.exr"), "--aov", aov})));
    const auto layers = image::readExr(path("a.exr"));
    ASSERT_EQ(layers.size(), 1u) << aov;
    EXPECT_EQ(layers[0].name, "color") << aov;
    EXPECT_EQ(layers[0].image.channels, 3u) << aov;
    EXPECT_GT(image::meanOf(layers[0].image), 0.0) << aov;
  }
}

TEST_F(RenderCommand, SlowEveryAovHasAPreview) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> byGraph = {
      {"direct", {"color", "direct", "irradiance_direct", "albedo", "normal", "position", "depth", "display"}},
      {"clustered_voxel", {"indirect", "face", "cluster"}}};
  for (const auto& [graph, aovs] : byGraph) {
    for (const std::string& aov : aovs) {
      ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--graph", graph, "--out", path("a.png"), "--aov", aov})));
      EXPECT_GT(image::meanOf(image::readPng(path("a.png"))), 0.01) << aov;
    }
  }
}

TEST_F(RenderCommand, ZeroBouncesLeaveTheIndirectChainOut) {
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--bounces", "0", "--out", path("a.exr"), "--stats", path("a.json"),
                                                                      "--aov", "color,direct,indirect,irradiance_indirect"})));
  const auto layers = image::readExr(path("a.exr"));
  for (const char* name : {"indirect", "irradiance_indirect"}) {
    ASSERT_NE(find(layers, name), nullptr);
    for (const float value : find(layers, name)->image.data) ASSERT_EQ(value, 0.f);
  }
  EXPECT_EQ(find(layers, "color")->image.data, find(layers, "direct")->image.data);
  const json stats = json::parse(read("a.json"));
  for (const char* node : {"voxelize", "cluster", "triangles", "visibility", "bounce", "gather_pixels"}) {
    EXPECT_TRUE(stats.at("culled").contains(node)) << node;
    EXPECT_FALSE(stats.at("nodes").contains(node)) << node;
  }
  EXPECT_EQ(stats.at("request").at("bounces"), 0);
  // Nothing but black to write: still a file.
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--bounces", "0", "--out", path("b.exr"), "--aov", "indirect"})));
  EXPECT_EQ(image::meanOf(image::readExr(path("b.exr")).at(0).image), 0.0);
}

TEST_F(RenderCommand, StatisticsSayWhatRan) {
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--out", path("a.exr"), "--stats", path("a.json"), "--frames", "3",
                                                                      "--set", "lights.shadow_resolution=512"})));
  const json stats = json::parse(read("a.json"));
  EXPECT_FALSE(stats.at("device").at("name").get<std::string>().empty());
  EXPECT_EQ(stats.at("scene").at("triangles"), 34);
  EXPECT_EQ(stats.at("scene").at("lights").at("point"), 1);
  EXPECT_EQ(stats.at("params").at("voxelize.resolution"), 16);
  EXPECT_EQ(stats.at("params").at("lights.shadow_resolution"), 512);
  EXPECT_EQ(stats.at("request").at("width"), 24);
  EXPECT_EQ(stats.at("request").at("bounces"), "all");
  EXPECT_GT(stats.at("counts").at("voxels"), 0);
  EXPECT_GE(stats.at("counts").at("faces"), stats.at("counts").at("clusters"));
  // Images grow with the picture: only the buffers of clustered_voxel nodes count.
  double owned = 0;
  for (const auto& [name, resource] : stats.at("memory").at("resources").items()) {
    const std::string node = name.substr(0, name.find('.'));
    const bool voxel =
        stats.at("nodes").contains(node) && stats.at("nodes").at(node).at("type").get<std::string>().rfind("clustered_voxel.", 0) == 0;
    if (voxel && resource.at("shape").get<std::string>().find("width") == std::string::npos) owned += resource.at("bytes").get<double>();
  }
  EXPECT_GT(owned, 0.0);
  EXPECT_DOUBLE_EQ(stats.at("bytes_per_voxel").get<double>(), owned / stats.at("counts").at("voxels").get<double>());
  // Memory: the device holds at least what the graph's resources ask for; the peak at least what is held now.
  const json& memory = stats.at("memory");
  uint64_t sum = 0;
  for (const auto& [name, resource] : memory.at("resources").items()) sum += resource.at("bytes").get<uint64_t>();
  EXPECT_EQ(memory.at("resources_total"), sum);
  EXPECT_GE(memory.at("device_peak"), memory.at("device_current"));
  // Lazy: the first of three equal frames does the work, the others nothing.
  ASSERT_EQ(stats.at("frames").size(), 3u);
  EXPECT_TRUE(stats.at("frames")[0].at("ran").size() > 10) << stats.at("frames")[0];
  EXPECT_EQ(stats.at("frames")[1].at("ran"), json::array());
  EXPECT_EQ(stats.at("frames")[2].at("ran"), json::array());
  for (const auto& [name, node] : stats.at("nodes").items()) EXPECT_EQ(node.at("runs"), 1) << name;
  const json& wall = stats.at("wall_ms");
  const double phases = wall.at("load").get<double>() + wall.at("prepare").get<double>() + wall.at("run").get<double>() +
                        wall.at("download").get<double>() + wall.at("write").get<double>();
  EXPECT_NEAR(phases, wall.at("total").get<double>(), 0.05 * phases);
}

// What the method keeps (docs/data_flow.md, Memory), and what it needs for a while beside.
TEST_F(RenderCommand, SlowMemoryAVoxelIsBounded) {
  ASSERT_NO_FATAL_FAILURE(
      expectDone(render("builtin:cornell_point", {"--graph", "clustered_voxel_pixels", "--out", path("a.exr"), "--stats", path("a.json"),
                                                  "--set", "visibility.rays=16", "--set", "voxelize.resolution=64"})));
  const json stats = json::parse(read("a.json"));
  const json& memory = stats.at("memory");
  EXPECT_LT(stats.at("bytes_per_voxel").get<double>(), 250.0) << memory.dump(2);
  EXPECT_LT(memory.at("device_peak").get<double>(), 1.5 * memory.at("device_current").get<double>());
}

TEST_F(RenderCommand, SlowTheSameCommandWritesTheSameFile) {
  for (const char* name : {"a", "b"}) {
    ASSERT_NO_FATAL_FAILURE(
        expectDone(render("builtin:cornell", {"--out", path(std::string(name) + ".exr"), "--out", path(std::string(name) + ".png")})));
  }
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  EXPECT_EQ(read("a.png"), read("b.png"));
}

TEST_F(RenderCommand, SupersamplingIsTheMeanOfALargerPicture) {
  const std::vector<std::string> scene = {"render", "builtin:cornell_point", "--graph", "direct", "--aov", "color,albedo"};
  auto large = scene, small = scene;
  large.insert(large.end(), {"--size", "48x32", "--out", path("large.exr")});
  small.insert(small.end(), {"--size", "24x16", "--supersample", "2", "--out", path("small.exr")});
  ASSERT_NO_FATAL_FAILURE(expectDone(large));
  ASSERT_NO_FATAL_FAILURE(expectDone(small));
  const auto a = image::readExr(path("large.exr")), b = image::readExr(path("small.exr"));
  for (const char* name : {"color", "albedo"}) {
    EXPECT_EQ(image::blockMeans(find(a, name)->image, 2).data, find(b, name)->image.data) << name;
  }
}

// Irradiance of a pixel is what its mean albedo reflects as its mean light, at edges too, and whether albedo was asked for or not.
TEST_F(RenderCommand, SupersampledIrradianceIsWeighedByAlbedo) {
  const std::vector<std::string> scene = {"render", "builtin:cornell_point", "--graph", "direct", "--size", "24x16", "--supersample", "3"};
  auto with = scene, without = scene;
  with.insert(with.end(), {"--aov", "irradiance_direct,direct,albedo", "--out", path("with.exr")});
  without.insert(without.end(), {"--aov", "irradiance_direct,direct", "--out", path("without.exr")});
  ASSERT_NO_FATAL_FAILURE(expectDone(with));
  ASSERT_NO_FATAL_FAILURE(expectDone(without));
  const auto a = image::readExr(path("with.exr")), b = image::readExr(path("without.exr"));
  const image::Image &e = find(a, "irradiance_direct")->image, &albedo = find(a, "albedo")->image, &direct = find(a, "direct")->image;
  EXPECT_EQ(e.data, find(b, "irradiance_direct")->image.data);
  size_t lit = 0;
  for (size_t i = 0; i < e.data.size(); ++i) {
    EXPECT_NEAR(e.data[i] * albedo.data[i] / 3.14159265f, direct.data[i], 1e-5f * direct.data[i]);
    if (direct.data[i] > 0.f) ++lit;
  }
  EXPECT_GT(lit, e.data.size() / 4);
}

/// Two small triangles in opposite corners of a cube: little surface, and a grid as large as the resolution makes it.
std::string cornersGltf() {
  std::vector<float> positions;
  for (const float at : {0.f, 0.99f}) {
    for (const auto& [x, y, z] : {std::array{0.f, 0.f, 0.f}, std::array{0.01f, 0.f, 0.01f}, std::array{0.f, 0.01f, 0.f}}) {
      for (const float v : {x, y, z}) positions.push_back(at + v);
    }
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(positions.data());
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string base64;
  for (size_t i = 0; i < positions.size() * 4; i += 3) {  // 72 bytes: no padding
    const unsigned word = static_cast<unsigned>(bytes[i] << 16 | bytes[i + 1] << 8 | bytes[i + 2]);
    for (const unsigned shift : {18u, 12u, 6u, 0u}) base64 += kDigits[(word >> shift) & 63u];
  }
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
    "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}},
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}],
    "bufferViews": [{"buffer": 0, "byteLength": 72}],
    "buffers": [{"byteLength": 72, "uri": "data:application/octet-stream;base64,)" +
         base64 + "\"}]}";
}

TEST_F(RenderCommand, SlowHardestResolutionWorksOrIsRefusedCleanly) {
  write("corners.gltf", cornersGltf());
  CommandSetup patient;
  patient.timeLimitSeconds = 800;
  for (const char* resolution : {"8", "1024"}) {
    const CommandResult result = runRadivox({"render", path("corners.gltf"), "--size", "8x8", "--set",
                                             std::string("voxelize.resolution=") + resolution, "--out", path("a.exr")},
                                            patient);
    const bool done = result.exitCode == 0;
    EXPECT_TRUE(done || (result.exitCode == 4 && resolution == std::string("1024"))) << result.exitCode << result.err;
    EXPECT_EQ(std::filesystem::exists(path("a.exr")), done);
    EXPECT_EQ(result.err.find("radivox: ") != std::string::npos, !done) << result.err;
    std::filesystem::remove(path("a.exr"));
  }
}

TEST_F(RenderCommand, AnEmptySceneIsAPicture) {
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:empty", {"--out", path("a.exr"), "--out", path("a.png")})));
  EXPECT_EQ(image::meanOf(image::readExr(path("a.exr")).at(0).image), 0.0);
}

TEST_F(RenderCommand, SlowInterruptionLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    CommandSetup setup;
    setup.signal = signal;
    setup.signalAfterMs = 300;
    const std::vector<std::string> before = files();
    // Many frames: certainly still at work when the signal comes.
    const CommandResult result = runRadivox(
        {"render", "builtin:cornell_point", "--size", "512x512", "--frames", "10000", "--out", path("a.exr"), "--stats", path("a.json")},
        setup);
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_EQ(result.err, "radivox: interrupted\n");
    EXPECT_EQ(files(), before);
  }
}

TEST_F(RenderCommand, SlowBuiltinScenesComeBackFromAFile) {
  ASSERT_NO_FATAL_FAILURE(expectDone({"scene", "cornell_point", "--out", path("c.glb")}));
  ASSERT_NO_FATAL_FAILURE(expectDone(render("builtin:cornell_point", {"--out", path("a.exr")})));
  ASSERT_NO_FATAL_FAILURE(expectDone(render(path("c.glb"), {"--out", path("b.exr")})));
  const auto a = image::readExr(path("a.exr")), b = image::readExr(path("b.exr"));
  EXPECT_GT(image::psnr(a.at(0).image, b.at(0).image), 50.0);
}

}  // namespace

}  // namespace radivox::test
