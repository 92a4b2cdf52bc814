// One row of the report: a setting, what it costs, and how wrong it is.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "engine/image/compare.h"

namespace radivox::report {

/// "visibility.rays" = "64"; also "lights.NAME", "request.bounces", "request.supersample".
using Change = std::pair<std::string, std::string>;

struct Setting {
  std::string graph;   ///< name; empty for the path tracer
  std::string preset;  ///< empty: the graph's own values
  std::vector<Change> changes;
  std::string bounces;   ///< the truth's, where the method has no bound of its own; empty: the method's
  uint32_t samples = 0;  ///< of the path tracer, a pixel

  std::string method() const;  ///< "clustered_voxel", "paper_64", "path_tracer"
  std::string print() const;   ///< "clustered_voxel visibility.rays=64"
};

/// Why it is there. A row is measured once and may serve several ends.
namespace why {
constexpr const char* kMethod = "method";  ///< a graph or preset as it is
constexpr const char* kSweep = "sweep";    ///< one parameter changed
constexpr const char* kExact = "exact";    ///< one parameter at its most exact, the rest as it is
constexpr const char* kSearch = "search";  ///< beside a setting of the front
constexpr const char* kPathTracer = "path_tracer";
}  // namespace why

struct NodeCost {
  std::string name, type;
  double sceneMs = 0, lightMs = 0, frameMs = 0;  ///< parts of Cost
};

struct MemoryCost {
  std::string name, meaning;
  uint64_t bytes = 0;
  bool scratch = false;  ///< shares memory with other scratch
};

/// Milliseconds, medians of `repeats`. Three things change: the camera moves a little, the lights change, the scene does. A node's
/// frameMs is what it takes when the camera moves; lightMs what it takes more than that when the lights change; sceneMs what it takes more than
/// both when the scene does (less than half as much again is noise, and counts as nothing). So the parts add up to what a first picture takes.
struct Cost {
  double sceneMs = 0;     ///< once a scene
  double lightMs = 0;     ///< once a change of light
  double frameMs = 0;     ///< every frame
  double overheadMs = 0;  ///< every frame, outside of nodes: recording, submitting, reading counts back
  double totalMs() const { return sceneMs + lightMs + frameMs + overheadMs; }
  double everyFrameMs() const { return frameMs + overheadMs; }
  double prepareMs = 0;                                      ///< pipelines, once a program
  double firstRunMs = 0;                                     ///< the first run of all, with what the driver compiles late
  double wallSceneMs = 0, wallLightMs = 0, wallFrameMs = 0;  ///< by the clock
  uint32_t repeats = 0;
  std::vector<NodeCost> nodes;
  std::vector<MemoryCost> memory;
  uint64_t deviceBytes = 0;  ///< allocated on the device, the scene included
  std::map<std::string, uint64_t> counts;
  std::map<std::string, double> figures;      ///< "visibility.rays"
  std::map<std::string, std::string> culled;  ///< node → reason
};

/// Relative figures are over the mean of the reference.
struct ErrorFigures {
  double bias = 1, biasLow = 1, biasHigh = 1;  ///< 95 % interval, equal to the value where the reference has no halves
  double rmse = 0, rmseLow = 0, rmseHigh = 0;
  double relRmse = 0, relRmseLow = 0, relRmseHigh = 0;
  double relMse = 0;
  double psnr = 0, psnrBlocks = 0;  ///< dB
  double flip = 0, flip99 = 0;
  double hdrFlip = -1;  ///< color alone; −1: not measured
};

struct Row {
  std::string scene, key;
  Setting setting;
  std::vector<std::string> reasons;  ///< why::…
  std::string about;                 ///< sweep and exact: the parameter
  Cost cost;
  ErrorFigures full, indirect;
  bool frontTotalFull = false, frontTotalIndirect = false, frontFrameFull = false, frontFrameIndirect = false;
  bool isPathTracer() const { return setting.samples > 0; }
  bool has(const std::string& reason) const;
};

/// What of a row is measured: settings, cost, errors. Not reasons and fronts, which depend on the other rows.
nlohmann::ordered_json toJson(const Row& row);
/// Throws nlohmann::json::exception on a file of another shape.
Row rowFromJson(const nlohmann::json& json);
std::string csvHeading();
/// One line; the floors are the scene's, relative RMSE.
std::string printCsv(const Row& row, double floorFull, double floorIndirect);

}  // namespace radivox::report
