// radivox vdb as a person runs it: every command of docs/vdb.md, what it refuses, and that other programs open what it writes.
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

namespace fs = std::filesystem;

class Vdb : public CommandTest {
 protected:
#ifndef RADIVOX_WITH_VDB
  void SetUp() override {
    CommandTest::SetUp();
    GTEST_SKIP() << "this build has no OpenVDB";
  }
#endif
  CommandResult run(const std::vector<std::string>& arguments) const {
    CommandSetup setup;
    setup.folder = folder_;
    CommandResult result = runRadivox(arguments, setup);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result;
  }
  /// `radivox vdb builtin:cornell` at a low N.
  CommandResult dump(const std::string& file, const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"vdb",   "builtin:cornell",        "--out", file,
                                    "--set", "voxelize.resolution=12", "--set", "visibility.rays=16"};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }
};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) {
    if (!word.empty()) words.push_back(word);
  }
  return words;
}

bool hasProgram(const std::string& name) {
  for (const std::string& folder : split(std::getenv("PATH"), ':')) {
    if (fs::exists(fs::path(folder) / name)) return true;
  }
  return false;
}

/// Lines of a document's ``` blocks that begin with `program`, as words.
std::vector<std::vector<std::string>> commandsOf(const std::string& document, const std::string& program) {
  std::ifstream file(RADIVOX_SOURCE_DIR "/" + document);
  std::vector<std::vector<std::string>> commands;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("```", 0) == 0) inside = !inside;
    if (inside && line.rfind(program + " ", 0) == 0) commands.push_back(split(line.substr(program.size() + 1), ' '));
  }
  return commands;
}

TEST_F(Vdb, EveryCommandOfItsPageRunsSlow) {
  const auto commands = commandsOf("docs/vdb.md", "radivox");
  ASSERT_EQ(commands.size(), 7u) << "a command was added or lost: look at what this test does with it";
  for (std::vector<std::string> command : commands) {
    std::string line;
    for (const std::string& word : command) line += " " + word;
    SCOPED_TRACE(line);
    const auto out = std::find(command.begin(), command.end(), "--out");
    const bool writes = out != command.end();
    const std::string file = writes ? *(out + 1) : "";
    if (writes && line.find("voxelize.resolution") == std::string::npos) {
      // As printed, but at a lower N: 128 is for people.
      command.insert(command.end(), {"--set", "voxelize.resolution=32"});
    }
    const CommandResult result = run(command);
    EXPECT_NE(result.out, "");
    EXPECT_TRUE(!writes || fs::exists(path(file))) << file;
  }
  for (const std::vector<std::string>& command : commandsOf("docs/vdb.md", "vdb_print")) {
    if (!hasProgram("vdb_print")) GTEST_SKIP() << "no vdb_print here (libopenvdb-tools)";
    std::string line = "cd '" + folder_.string() + "' && vdb_print";
    for (const std::string& word : command) line += " " + word;
    ASSERT_EQ(std::system((line + " > printed 2>&1").c_str()), 0) << read("printed");
    for (const char* word : {"occupancy", "indirect_pos_y", "radivox_unit", "builtin:cornell", "fog volume"})
      EXPECT_NE(read("printed").find(word), std::string::npos) << word;
  }
}

TEST_F(Vdb, SaysWhatItWrote) {
  const CommandResult result = dump("a.vdb", {"--grids", "occupancy,fragment_count,area_faces"});
  EXPECT_NE(result.out.find("a.vdb: 8 grids of "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("N = 12"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("memory at most"), std::string::npos) << result.out;
  const std::string text = run({"vdb", "--print", path("a.vdb")}).out;
  EXPECT_NE(text.find("occupancy: float, fog volume, "), std::string::npos) << text;
  EXPECT_NE(text.find("fragment_count: int32, unknown, "), std::string::npos) << text;
  EXPECT_NE(text.find("area_neg_z"), std::string::npos) << text;
  EXPECT_NE(text.find("radivox_scene = builtin:cornell"), std::string::npos) << text;
  EXPECT_NE(text.find("voxel (0, 0, 0) at"), std::string::npos) << text;
}

TEST_F(Vdb, FilesAreComparedGridByGridSlow) {
  dump("a.vdb", {"--grids", "occupancy,direct"});
  dump("b.nvdb", {"--grids", "occupancy,direct"});
  EXPECT_EQ(split(run({"vdb", "--diff", path("a.vdb"), path("b.nvdb")}).out, '\n').back(), "identical");
  dump("c.vdb", {"--grids", "direct,albedo", "--set", "inject.method=points"});
  const std::string text = run({"vdb", "--diff", path("a.vdb"), path("c.vdb")}).out;
  EXPECT_NE(text.find("occupancy: only in A"), std::string::npos) << text;
  EXPECT_NE(text.find("albedo: only in B"), std::string::npos) << text;
  EXPECT_NE(text.find(" common ones differ, by at most "), std::string::npos) << text;
  EXPECT_EQ(split(text, '\n').back(), "different");
  dump("d.vdb", {"--grids", "occupancy", "--up", "z"});
  EXPECT_NE(run({"vdb", "--diff", path("a.vdb"), path("d.vdb")}).out.find("occupancy: A has voxels of"), std::string::npos);
}

TEST_F(Vdb, HelpListsEveryGrid) {
  const std::string text = run({"vdb", "--grids", "help"}).out;
  const std::string page = [] {
    std::ifstream file(RADIVOX_SOURCE_DIR "/docs/vdb.md");
    return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  }();
  for (const char* name : {"occupancy", "fragment_count", "mean_normal", "albedo", "area", "cluster_id", "cluster_color", "cluster_normal",
                           "lit", "direct", "indirect", "visible_clusters", "misses", "error"}) {
    EXPECT_NE(text.find("  " + std::string(name) + " "), std::string::npos) << name;
    EXPECT_NE(page.find("| `" + std::string(name) + "` |"), std::string::npos) << name << " is not in docs/vdb.md";
  }
}

TEST_F(Vdb, WhatItRefuses) {
  const std::string scene = path("none.glb");  // not there: that would be the later error
  expectError({"vdb"}, 2, {"SCENE"});
  expectError({"vdb", scene}, 2, {"--out", ".vdb"});
  expectError({"vdb", scene, "--out", path("a.obj")}, 2, {"a.obj", ".vdb", ".nvdb"});
  expectError({"vdb", scene, "--out", path("no/a.vdb")}, 2, {"no", "does not exist"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--out", path("b.vdb")}, 2, {"--out", "twice"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--grids", "occupncy"}, 2, {"'occupncy'", "'occupancy'"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--grids", "direct_pos_w"}, 2, {"'direct_pos_w'", "'direct_pos_"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--grids", "occupancy,"}, 2, {"unknown grid ''"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--faces", "some"}, 2, {"--faces", "view"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--up", "x"}, 2, {"--up"});
  expectError({"vdb", scene, "--out", path("a.vdb")}, 2, {"none.glb"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--graph", "direct"}, 2, {"graph direct", "no voxels", "clustered_voxel"});
  expectError({"vdb", scene, "--out", path("a.vdb"), "--graph", "clustered_voxel_pixels", "--grids", "indirect"}, 2,
              {"'indirect'", "clustered_voxel.gather", "--graph clustered_voxel"});
  expectError({"vdb", "builtin:cornell", "--print", path("a.vdb")}, 2, {"--print", "SCENE"});
  expectError({"vdb", "--diff", path("a.vdb")}, 2, {"--diff"});
}

TEST_F(Vdb, FilesThatAreNoneSlow) {
  expectError({"vdb", "--print", path("none.vdb")}, 2, {"none.vdb", "no such file"});
  write("empty.vdb", "");
  write("text.vdb", "this is no file of voxels");
  dump("a.vdb", {"--grids", "occupancy,cluster_color"});
  dump("a.nvdb", {"--grids", "occupancy,cluster_color"});
  for (const char* kind : {".vdb", ".nvdb"}) {
    const std::string whole = read(std::string("a") + kind);
    for (const size_t length : {size_t{12}, size_t{40}, whole.size() / 2, whole.size() - 30}) {
      write(std::string("cut") + kind, whole.substr(0, length));
      expectError({"vdb", "--print", path(std::string("cut") + kind)}, 2, {std::string("cut") + kind});
    }
  }
  expectError({"vdb", "--print", path("empty.vdb")}, 2, {"empty.vdb"});
  expectError({"vdb", "--diff", path("a.vdb"), path("text.vdb")}, 2, {"text.vdb"});
}

TEST_F(Vdb, AFullDiskLeavesNothingSlow) {
  // The file size limit is a full disk that a test can have.
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old = ::signal(SIGXFSZ, SIG_IGN);
  struct rlimit tight = before;
  tight.rlim_cur = 20000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  CommandSetup setup;
  setup.environment["RADIVOX_PIPELINE_CACHE"] = "";
  for (const char* file : {"a.vdb", "a.nvdb"}) {
    expectError({"vdb", "builtin:cornell", "--set", "voxelize.resolution=40", "--grids", "albedo,mean_normal_faces,area_faces", "--out",
                 path(file)},
                2, {file, "size limit"}, setup);
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, old);
}

TEST_F(Vdb, GroupsLeaveOutWhatTheGraphLacksAndSaySoSlow) {
  const CommandResult result = runRadivox({"vdb", "builtin:cornell", "--graph", "clustered_voxel_pixels", "--set", "voxelize.resolution=8",
                                           "--set", "visibility.rays=4", "--out", path("a.vdb")});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.err.find("warning: left out indirect, "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("clustered_voxel.gather"), std::string::npos) << result.err;
  EXPECT_LE(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
}

TEST_F(Vdb, TheNodeWritesFromAGraphFile) {
  write("dump.json", R"({"nodes": {
    "voxelize": {"type": "clustered_voxel.voxelize", "params": {"resolution": 10}},
    "index": {"type": "clustered_voxel.index"},
    "gbuffer": {"type": "frame.gbuffer"},
    "dump": {"type": "vdb.write", "params": {"file": "from_graph.vdb", "grids": "occupancy", "scene": "mine"}}},
  "edges": [["voxelize.grid", "index.grid"], ["voxelize.occupancy", "index.occupancy"],
            ["voxelize.grid", "dump.grid"], ["index.voxels", "dump.voxels"]],
  "outputs": ["gbuffer.albedo"], "aovs": {"color": "gbuffer.albedo"}})");
  run({"render", "builtin:cornell", "--graph", path("dump.json"), "--size", "16x16", "--out", path("a.png")});
  EXPECT_NE(run({"vdb", "--print", path("from_graph.vdb")}).out.find("radivox_scene = mine"), std::string::npos);
  expectError({"render", "builtin:cornell", "--graph", path("dump.json"), "--set", "dump.grids=ocupancy", "--out", path("b.png")}, 2,
              {"dump.grids", "'occupancy'"});
  expectError({"render", "builtin:cornell", "--graph", path("dump.json"), "--set", "dump.file=a.txt", "--out", path("b.png")}, 2,
              {"dump.file", ".vdb"});
}

TEST_F(Vdb, BlenderImportsItSlow) {
  if (!hasProgram("blender")) GTEST_SKIP() << "no Blender here";
  dump("a.vdb", {"--grids", "default", "--up", "z"});
  // Of a scene of 5.5 m: where voxel 0 is, and what was up stays up.
  write("import.py", R"(
import bpy, sys
bpy.ops.object.volume_import(filepath=sys.argv[-1])
volume = bpy.context.object.data
assert volume.grids.load(), volume.grids.error_message
for grid in volume.grids:
    assert grid.load(), grid.name
    print('GRID', grid.name, grid.data_type, grid.channels, *[round(x, 4) for row in grid.matrix_object for x in row])
print('BOUNDS', *[round(x, 3) for x in bpy.context.object.dimensions])
)");
  const std::string line =
      "cd '" + folder_.string() +
      "' && HOME=. timeout 120 blender --background --factory-startup --python-exit-code 7 --python import.py -- a.vdb > log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0) << read("log");
  const std::string log = read("log");
  std::set<std::string> names;
  for (const std::string& row : split(log, '\n')) {
    const std::vector<std::string> words = split(row, ' ');
    if (words.empty() || words[0] != "GRID") continue;
    names.insert(words.at(1));
    const std::string type = words.at(2);
    const bool isVector = words.at(3) == "3";
    EXPECT_EQ(isVector, type == "VECTOR_FLOAT") << row;
    // glTF's y is Blender's z: column 1 of the matrix (index j) points along +z.
    EXPECT_EQ(words.at(4 + 1), "0.0") << row;
    EXPECT_GT(std::stod(words.at(4 + 8 + 1)), 0.0) << row;
  }
  EXPECT_EQ(names.size(), 32u) << log;
  for (const char* name : {"occupancy", "mean_normal", "cluster_color", "direct_pos_y", "indirect_neg_x"})
    EXPECT_EQ(names.count(name), 1u) << name;
}

TEST_F(Vdb, CtrlCEndsItCleanlySlow) {
  CommandSetup setup;
  setup.signal = SIGINT;
  setup.signalAfterMs = 300;
  const CommandResult result = runRadivox(
      {"vdb", "builtin:atrium", "--set", "voxelize.resolution=256", "--set", "visibility.rays=256", "--out", path("a.vdb")}, setup);
  EXPECT_EQ(result.exitCode, 130) << result.err;
  EXPECT_TRUE(files().empty());
}

}  // namespace

}  // namespace radivox::test
