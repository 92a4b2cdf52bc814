// What can be wrong with a command line: each a line that names it, the right exit code, and nothing left behind.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class Usage : public CommandTest {
 protected:
  /// `radivox render builtin:box … --out a.exr` with what is under test.
  std::vector<std::string> render(std::vector<std::string> more) const {
    std::vector<std::string> all = {"render", "builtin:box", "--out", path("a.exr")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(Usage, HelpAndVersionAreNotErrors) {
  for (const char* what : {"--help", "--version"}) {
    const CommandResult result = runRadivox({what});
    EXPECT_EQ(result.exitCode, 0) << what;
    EXPECT_EQ(result.err, "") << what;
    EXPECT_NE(result.out.find("radivox"), std::string::npos) << what;
  }
  for (const char* command : {"render", "reference", "compare", "report", "graph", "scene", "info", "nodes"}) {
    const CommandResult result = runRadivox({command, "--help"});
    EXPECT_EQ(result.exitCode, 0) << command;
    EXPECT_NE(result.out.find("Usage"), std::string::npos) << result.out;
  }
  EXPECT_NE(runRadivox({"--help"}).out.find("130"), std::string::npos) << "exit codes are listed";
}

TEST_F(Usage, HelpNamesTheGraphThatIsTaken) {
  const auto defaultOf = [](const std::string& command) {
    const std::string help = runRadivox({command, "--help"}).out;
    const size_t graph = help.find("--graph"), begin = help.find("clustered_voxel", graph);
    return help.substr(begin, help.find(')', begin) - begin);
  };
  for (const char* command : {"render", "graph", "needs", "moves"}) EXPECT_EQ(defaultOf(command), "clustered_voxel_pixels") << command;
  for (const char* command : {"vdb", "view"}) EXPECT_EQ(defaultOf(command), "clustered_voxel") << command;
  const auto plan = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"graph", "builtin:box"});
    return runRadivox(more).out;
  };
  EXPECT_EQ(plan({}), plan({"--graph", "clustered_voxel_pixels", "--supersample", "2"})) << "as the default preset has it";
  EXPECT_NE(plan({}), plan({"--graph", "clustered_voxel"}));
}

TEST_F(Usage, CommandsAndOptionsAreSpelledForYou) {
  expectError({}, 2, {"command", "render"});
  expectError({"rendr"}, 2, {"'rendr'", "'render'"});
  expectError({"--vesion"}, 2, {"'--vesion'", "'--version'"});
  expectError(render({"--sise", "10x10"}), 2, {"'--sise'", "'--size'"});
  expectError(render({"--sise=10x10"}), 2, {"'--sise'", "'--size'"});
  expectError(render({"--quux"}), 2, {"'--quux'", "--help"});
  expectError(render({"more"}), 2, {"'more'"});
  expectError(render({"--size"}), 2, {"--size"});
  expectError({"render", "--out", path("a.exr")}, 2, {"SCENE"});
  expectError({"render", "builtin:box"}, 2, {"--out"});
  expectError({"scene", "--out", path("a.glb")}, 2, {"NAME"});
  expectError({"scene", "box"}, 2, {"--out"});
}

TEST_F(Usage, ASceneMayBeNamedLikeACommand) { expectError({"render", "scene", "--out", path("a.exr")}, 2, {"scene:", "no such file"}); }

TEST_F(Usage, NumbersOutOfRangeNameTheRange) {
  for (const char* size :
       {"0x10", "10x0", "10", "x", "10x", "x10", "-1x10", "10x10x10", "16385x10", "10x99999999999", "1e2x10", "ax10", ""}) {
    expectError(render({"--size", size}), 2, {"--size", "16384"});
  }
  for (const char* bounces : {"-1", "1.5", "many", "4294967296", ""}) expectError(render({"--bounces", bounces}), 2, {"--bounces", "all"});
  expectError(render({"--frames", "0"}), 2, {"--frames", "1"});
  expectError(render({"--supersample", "9"}), 2, {"--supersample", "8"});
  expectError(render({"--supersample", "8", "--size", "4000x4"}), 2, {"--supersample", "16384"});
  expectError(render({"--device", "first"}), 2, {"--device", "'first'"});
}

TEST_F(Usage, ScenesThatAreNotThere) {
  expectError({"render", path("none.glb"), "--out", path("a.exr")}, 2, {"none.glb"});
  expectError({"render", folder_.string(), "--out", path("a.exr")}, 2, {folder_.string()});
  expectError({"render", "builtin:cornel", "--out", path("a.exr")}, 2, {"cornel", "cornell"});
  write("empty.glb", "");
  write("text.gltf", "hello");
  write("truncated.glb", std::string("glTF\x02\0\0\0\xff\0\0\0", 12));
  write("bad.gltf",
        R"({"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}], "nodes": [{"mesh": 0}]})");
  for (const char* name : {"empty.glb", "text.gltf", "truncated.glb", "bad.gltf"}) {
    expectError({"render", path(name), "--out", path("a.exr")}, 2, {name});
    expectError({"graph", path(name)}, 2, {name});
  }
  expectError(render({"--camera", "nowhere"}), 2, {"nowhere"});
  expectError(render({"--camera", "99"}), 2, {"99"});
}

TEST_F(Usage, FilesThatCannotBeWrittenAreRefusedBeforeTheWork) {
  // A scene that is not there would be the later error.
  const std::string scene = path("none.glb");
  expectError({"render", scene, "--out", path("no/folder/a.exr")}, 2, {"no/folder", "does not exist"});
  expectError({"render", scene, "--out", folder_.string() + "/"}, 2, {folder_.string()});
  expectError({"render", scene, "--out", path("a.jpg")}, 2, {"a.jpg", ".exr", ".png"});
  expectError({"render", scene, "--out", path("a")}, 2, {".exr"});
  expectError({"render", scene, "--out", "/proc/a.exr"}, 2, {"/proc"});
  expectError({"scene", "box", "--out", "/proc/a.glb"}, 2, {"/proc"});
  expectError({"stability", "--out", "/proc/a"}, 2, {"/proc/a"});
#ifdef RADIVOX_WITH_REFERENCE
  expectError({"reference", scene, "--out", "/proc/a.exr"}, 2, {"/proc"});
  expectError({"reference", scene, "--out", path("no/folder/a.exr")}, 2, {"no/folder", "does not exist"});
  expectError({"reference", scene, "--out", path("a.exr"), "--checkpoint", "/proc/a.state"}, 2, {"/proc"});
#endif
#ifdef RADIVOX_WITH_VDB
  expectError({"vdb", scene, "--out", "/proc/a.vdb"}, 2, {"/proc"});
  expectError({"vdb", scene, "--out", path("no/folder/a.vdb")}, 2, {"no/folder", "does not exist"});
#endif
  expectError({"render", scene, "--out", path("a.png"), "--aov", "color,albedo"}, 2, {"a.png", ".exr"});
  expectError({"render", scene, "--out", path("a.exr"), "--stats", path("no/a.json")}, 2, {"does not exist"});
  expectError({"render", scene, "--out", path("a.exr"), "--stats", path("a.txt")}, 2, {"a.txt", ".json"});
  expectError({"render", scene, "--out", path("a.exr"), "--out", path("a.exr")}, 2, {"twice"});
  expectError({"scene", "box", "--out", path("no/a.glb")}, 2, {"does not exist"});
  expectError({"scene", "box", "--out", path("a.gltf")}, 2, {".glb"});
  expectError({"scene", "bocks", "--out", path("a.glb")}, 2, {"bocks"});
}

TEST_F(Usage, NamesOfTheGraphAreSpelledForYou) {
  expectError(render({"--graph", "clustered_voxels"}), 2, {"graph", "'clustered_voxel'"});
  expectError(render({"--preset", "papr_64"}), 2, {"preset", "'paper_64'"});
  expectError(render({"--aov", "colour"}), 2, {"AOV", "'color'"});
  expectError(render({"--aov", "color,,albedo"}), 2, {"--aov"});
  expectError(render({"--aov", "color,color"}), 2, {"--aov", "twice"});
  expectError(render({"--graph", "direct", "--aov", "indirect"}), 2, {"'indirect'", "albedo"});
  expectError(render({"--set", "voxelise.resolution=64"}), 2, {"voxelise", "voxelize"});
  expectError(render({"--set", "voxelize.resolutoin=64"}), 2, {"resolutoin", "resolution"});
  expectError(render({"--set", "voxelize.resolution"}), 2, {"node.param=value"});
  expectError(render({"--set", "=64"}), 2, {"node.param=value"});
  expectError(render({"--set", "lights.shadow_resolutoin=64"}), 2, {"shadow_resolution"});
  for (const char* value : {"0", "3", "abc", "", "64.5", "-8", "1e9", "nan", "inf"}) {
    expectError(render({"--set", std::string("voxelize.resolution=") + value}), 2, {"voxelize.resolution", "1024"});
  }
  expectError({"graph", "builtin:box", "--format", "yaml"}, 2, {"yaml", "dot"});
}

TEST_F(Usage, GraphAndPresetFilesOfOnesOwn) {
  expectError(render({"--graph", path("none.json")}), 2, {"none.json"});
  expectError(render({"--preset", path("none.json")}), 2, {"none.json"});
  write("broken.json", "{");
  expectError(render({"--graph", path("broken.json")}), 2, {"broken.json"});
  expectError(render({"--preset", path("broken.json")}), 2, {"broken.json"});
  write("list.json", "[]");
  expectError(render({"--graph", path("list.json")}), 2, {"list.json"});
  expectError(render({"--preset", path("list.json")}), 2, {"list.json"});
  write("type.json", R"({"nodes": {"a": {"type": "frame.gbufer"}}, "edges": [], "outputs": []})");
  expectError(render({"--graph", path("type.json")}), 2, {"type.json", "frame.gbuffer"});
  write("key.json", R"({"nodes": {"gbuffer": {"type": "frame.gbuffer"}}, "edges": [], "outputs": [], "edgs": []})");
  expectError(render({"--graph", path("key.json")}), 2, {"key.json", "edgs"});
  write("preset.json", R"({"set": {"voxelize.resolutoin": 64}})");
  expectError(render({"--preset", path("preset.json")}), 2, {"preset.json", "resolution"});
  write("request.json", R"({"request": {"bounces": -3}})");
  expectError(render({"--preset", path("request.json")}), 2, {"request.json", "bounces"});
  write("deep.json", R"({"request": {"bounces": )" + std::string(200000, '[') + std::string(200000, ']') + "}}");
  expectError(render({"--preset", path("deep.json")}), 2, {"deep.json", "deep"});
  expectError(render({"--graph", path("deep.json")}), 2, {"deep.json"});
  write("deep_param.json", R"({"nodes": {"gbuffer": {"type": "frame.gbuffer", "params": {"sides": )" + std::string(200000, '[') +
                               std::string(200000, ']') + "}}}}");
  expectError(render({"--graph", path("deep_param.json")}), 2, {"deep_param.json"});
  // Broken UTF-8 in what is quoted back.
  write("utf8.json", "{\"set\": {\"\xff\xfe.x\": 1}}");
  expectError(render({"--preset", path("utf8.json")}), 2, {"utf8.json"});
  expectError(render({"--module", path("none.so")}), 2, {"none.so"});
}

TEST_F(Usage, NoDeviceIsExitCode3) {
  write("driver.json", "");
  CommandSetup setup;
  // Loaders before 1.3.207 know only the second name.
  setup.environment = {{"VK_DRIVER_FILES", path("driver.json")}, {"VK_ICD_FILENAMES", path("driver.json")}};
  expectError(render({"--size", "8x8"}), 3, {"Vulkan", "install"}, setup);
  expectError(render({"--size", "8x8", "--device", "0"}), 3, {"Vulkan"}, setup);
  // The plan needs none, and info says so.
  const CommandResult plan = runRadivox({"graph", "builtin:box", "--size", "8x8"}, setup);
  EXPECT_EQ(plan.exitCode, 0) << plan.err;
  EXPECT_NE(plan.out.find("voxelize"), std::string::npos);
  const CommandResult info = runRadivox({"info"}, setup);
  EXPECT_EQ(info.exitCode, 0) << info.err;
  EXPECT_NE(info.out.find("none:"), std::string::npos);
  EXPECT_NE(info.out.find("voxelize"), std::string::npos);
}

TEST_F(Usage, ADeviceThatIsNotThereIsExitCode3) { expectError(render({"--size", "8x8", "--device", "99"}), 3, {"99"}); }

TEST_F(Usage, AFullStandardOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string line = RADIVOX_BINARY_DIR "/bin/radivox graph builtin:box > /dev/full 2> " + path("err");
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
  EXPECT_NE(read("err").find("standard output"), std::string::npos);
}

}  // namespace

}  // namespace radivox::test
