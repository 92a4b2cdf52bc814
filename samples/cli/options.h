// What the command line says, as text and checked values; one struct for all subcommands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace radivox::cli {

struct Options {
  std::string scene;
  std::string sky;  ///< takes the place of the scene's own; empty: that
  std::optional<std::string> graph;
  std::vector<std::string> presets;
  std::vector<std::string> sets;  ///< "node.param=value"
  std::vector<std::string> modules;
  std::string camera;
  std::string size = "960x540";
  std::optional<std::string> bounces;
  std::string aovs = "color";  ///< comma-separated
  std::vector<std::string> outputs;
  std::string stats;
  std::string format = "text";
  std::string device = "-1";
  std::string frames = "1";
  std::string supersample;  ///< empty: what the preset says, or 1
  bool validate = false;
  bool keepAll = false;
  // render: settings by what they cost and how wrong they are
  std::string maxError;
  std::string budgetMs;
  std::string calibrationTime = "120";
  // compare
  std::string reference;  ///< "A" or "A,B"
  std::string test;
  std::string layer = "color";
  std::string weights;
  std::string json;
};

/// What `radivox reference` takes beside SCENE, --camera, --size, --bounces, --aov, --out and --stats.
struct ReferenceOptions {
  std::string spp = "64";
  std::string seed = "0";
  std::string samplesPerPass = "0";
  std::string targetError;
  std::string timeLimit;
  std::string threads = "0";
  std::string sides = "both";
  std::string checkpoint;
  std::string resume;
  std::string probe;
  bool halves = false;
};

/// What `radivox vdb` takes beside SCENE, --graph and the like, and --out.
struct VdbOptions {
  std::string grids;              ///< empty: the default
  std::string faces = "all";      ///< or "view"
  std::string up = "y";           ///< or "z"
  std::string print;              ///< instead: this file
  std::vector<std::string> diff;  ///< instead: these two
};

/// What `radivox bench` takes beside SCENE, --graph, --set and --out.
struct BenchOptions {
  std::string rays = "1000000";
  std::string runs = "5";
  std::string threads = "0";
};

struct Size {
  uint32_t width = 0, height = 0;
};
constexpr uint32_t kMaxSide = 16384;

/// All throw BadInput naming the option, what was given and what is allowed.
Size parseSize(const std::string& text);
uint32_t parseWhole(const std::string& option, const std::string& text, uint32_t min, uint32_t max);
uint32_t parseBounces(const std::string& text);  ///< a number or "all"
double parsePositive(const std::string& option, const std::string& text);
int parseDevice(const std::string& text);
std::vector<std::string> parseList(const std::string& option, const std::string& text);  ///< "a,b,c": no empty or repeated names

int runRender(const Options& options);
int runReference(const Options& options, const ReferenceOptions& reference);
int runVdb(const Options& options, const VdbOptions& vdb);
int runGraph(const Options& options);
/// A table of what leaving out saves; `options` without a scene.
int runNeeds(const Options& options, const std::vector<std::string>& scenes, const std::string& runs);
/// What pictures cost after shares of the scene have moved: percents, comma-separated.
int runMoves(const Options& options, const std::string& shares);
/// Speed of voxel rays beside Embree.
int runBench(const Options& options, const BenchOptions& bench);
int runScene(const Options& options);
int runInfo(const Options& options);
int runNodes(const Options& options);
int runCompare(const Options& options);

}  // namespace radivox::cli
