// Graphs and presets inside the binary: each must fit the nodes of this build.
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json parseFile(const fs::path& path) {
  std::ifstream file(path);
  return json::parse(std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()));
}

std::vector<fs::path> listAssets(const std::string& kind) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(RADIVOX_SOURCE_DIR) / "samples" / kind)) {
#ifndef RADIVOX_WITH_REFERENCE
    if (entry.path().stem() == "reference") continue;
#endif
    paths.push_back(entry.path());
  }
  EXPECT_FALSE(paths.empty()) << kind;
  return paths;
}

/// What `radivox info` says of a node type: its line and the indented ones below it.
std::string sectionOf(const std::string& info, const std::string& type) {
  const size_t begin = info.find("\n  " + type + " (");
  if (begin == std::string::npos) return "";
  size_t end = info.find('\n', begin + 1);
  while (end != std::string::npos && info.compare(end, 5, "\n    ") == 0) end = info.find('\n', end + 1);
  return info.substr(begin, end - begin);
}

TEST(Assets, SlowEveryGraphCompilesForEveryKindOfScene) {
  const std::string info = runRadivox({"info"}).out;
  for (const fs::path& path : listAssets("graphs")) {
    const std::string name = path.stem();
    EXPECT_EQ(runRadivox({"graph", "builtin:cornell", "--graph", path}).out, runRadivox({"graph", "builtin:cornell", "--graph", name}).out);
    EXPECT_NE(info.find("\n  " + name + ": "), std::string::npos) << name << " is listed with its help";
    for (const char* scene : {"builtin:cornell", "builtin:cornell_point", "builtin:furnace", "builtin:plane", "builtin:empty"}) {
      for (const char* bounces : {"0", "1", "all"}) {
        const CommandResult result = runRadivox({"graph", scene, "--graph", name, "--bounces", bounces});
        EXPECT_EQ(result.exitCode, 0) << name << " of " << scene << ": " << result.err;
        EXPECT_NE(result.out.find("gbuffer"), std::string::npos);
      }
    }
  }
}

TEST(Assets, SlowEveryAovOfAGraphCanBePlanned) {
  for (const fs::path& path : listAssets("graphs")) {
    const json graph = parseFile(path);
    EXPECT_TRUE(graph.at("aovs").contains("color"));
    for (const auto& [aov, endpoint] : graph.at("aovs").items()) {
      const CommandResult result = runRadivox({"graph", "builtin:cornell", "--graph", path.stem(), "--aov", aov});
      EXPECT_EQ(result.exitCode, 0) << path << " " << aov << ": " << result.err;
    }
  }
}

TEST(Assets, EveryPresetAppliesToItsGraph) {
  const std::string info = runRadivox({"info"}).out;
  for (const fs::path& path : listAssets("presets")) {
    const json preset = parseFile(path);
    EXPECT_EQ(preset.at("name").get<std::string>(), path.stem().string()) << path;
    EXPECT_NE(info.find("\n  " + path.stem().string() + ": "), std::string::npos) << path;
    for (const std::string& name : {path.stem().string(), path.string()}) {
      const CommandResult result = runRadivox({"graph", "builtin:cornell", "--preset", name});
      EXPECT_EQ(result.exitCode, 0) << name << ": " << result.err;
    }
  }
}

TEST(Assets, TheDefaultPresetIsWhatRunsWithoutAny) {
  const CommandResult plain = runRadivox({"graph", "builtin:cornell", "--format", "json"});
  const CommandResult preset = runRadivox({"graph", "builtin:cornell", "--format", "json", "--preset", "default"});
  ASSERT_EQ(plain.exitCode, 0) << plain.err;
  EXPECT_EQ(plain.out, preset.out);
  EXPECT_NE(plain.out, runRadivox({"graph", "builtin:cornell", "--format", "json", "--graph", "clustered_voxel_pixels"}).out);
  // Every setting of the preset is what its graph runs with: the node's own default, or what the graph says.
  const json asset = parseFile(fs::path(RADIVOX_SOURCE_DIR) / "samples/presets/default.json");
  const json set = asset.at("set");
  const uint32_t supersample = asset.at("request").at("supersample");
  const json graph = parseFile(fs::path(RADIVOX_SOURCE_DIR) / "samples/graphs/clustered_voxel_pixels.json").at("nodes");
  EXPECT_FALSE(set.empty());
  const std::string info = runRadivox({"info"}).out;
  for (const auto& [name, value] : set.items()) {
    const size_t dot = name.find('.');
    const std::string node = name.substr(0, dot), parameter = name.substr(dot + 1);
    const json params = graph.at(node).value("params", json::object());
    if (params.contains(parameter)) {
      EXPECT_EQ(params.at(parameter), value) << name;
      continue;
    }
    const std::string section = sectionOf(info, "clustered_voxel." + node);
    // As many rays a pixel of the picture as the node takes by itself.
    const bool isShared = name == "gather_pixels.rays";
    const json whole = isShared ? json(value.get<uint32_t>() * supersample * supersample) : value;
    const std::string text = whole.is_string() ? whole.get<std::string>() : whole.dump();
    EXPECT_NE(section.find("\n    " + parameter + " = " + text + "  ("), std::string::npos) << name << " in " << section;
  }
}

TEST(Assets, PlansComeInThreeFormats) {
  const CommandResult text = runRadivox({"graph", "builtin:cornell_point"});
  EXPECT_NE(text.out.find("composite"), std::string::npos);
  const CommandResult dot = runRadivox({"graph", "builtin:cornell_point", "--format", "dot"});
  EXPECT_EQ(dot.out.rfind("digraph", 0), 0u) << dot.out.substr(0, 40);
  const CommandResult parsed = runRadivox({"graph", "builtin:cornell_point", "--format", "json"});
  EXPECT_TRUE(json::accept(parsed.out));
}

TEST(Assets, InfoListsWhatThereIs) {
  const CommandResult info = runRadivox({"info"});
  ASSERT_EQ(info.exitCode, 0) << info.err;
  for (const char* word : {"radivox ", "devices", "conservative rasterization", "clustered_voxel.voxelize",
                           "resolution = ", "builtin:atrium", "emitter_samples", "graphs", "presets"}) {
    EXPECT_NE(info.out.find(word), std::string::npos) << word;
  }
}

}  // namespace

}  // namespace radivox::test
