// All that was measured, and how it is written down.
#pragma once

#include "samples/report/sweep.h"
#include "samples/report/truth.h"

namespace radivox::report {

struct SceneResults {
  std::string name;    ///< "sponza"
  std::string source;  ///< as on the command line
  std::string camera;
  uint64_t triangles = 0;
  std::string truth;  ///< SceneTruth::about
  std::string truthKey;
  std::vector<std::string> truthFiles;  ///< what `radivox compare` takes as REF
  double shareOfA = 0.5;
  double floorFull = 0, floorIndirect = 0;
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< what was left out, one line each
};

struct Results {
  std::string device, driver, host;  ///< host: what the path tracer runs on
  uint32_t width = 0, height = 0;
  std::string bounces;            ///< of the truth
  std::vector<std::string> sets;  ///< of every method
  std::string folder;
  std::vector<SceneResults> scenes;
};

/// data.csv and data.json.
void writeData(const Results& results);

/// The line that renders a row's picture again.
std::string commandFor(const Results& results, const SceneResults& scene, const Row& row);

nlohmann::ordered_json toJson(const Results& results, bool withNodes);

}  // namespace radivox::report
