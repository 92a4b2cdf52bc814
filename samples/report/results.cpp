#include "samples/report/results.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace radivox::report {

using nlohmann::ordered_json;

std::string commandFor(const Results& results, const SceneResults& scene, const Row& row) {
  const Setting& s = row.setting;
  const std::string size = " --size " + std::to_string(results.width) + "x" + std::to_string(results.height);
  const std::string camera = scene.camera.empty() ? "" : " --camera '" + scene.camera + "'";
  if (row.isPathTracer()) {
    return "radivox reference '" + scene.source + "'" + size + camera + " --bounces " + results.bounces + " --spp " +
           std::to_string(s.samples) + " --out picture.exr";
  }
  std::string command = "radivox render '" + scene.source + "'" + size + camera;
  command += s.preset.empty() ? " --graph " + s.graph : " --preset " + s.preset;
  const bool changed = std::any_of(s.changes.begin(), s.changes.end(), [](const Change& c) { return c.first == "request.bounces"; });
  if (!s.bounces.empty() && !changed) command += " --bounces " + s.bounces;
  for (const std::string& set : results.sets) command += " --set " + set;
  for (const auto& [name, value] : s.changes) {
    if (name == "request.bounces") {
      command += " --bounces " + value;
    } else if (name == "request.supersample") {
      command += " --supersample " + value;
    } else {
      command += " --set " + name + "=" + value;
    }
  }
  return command + " --out picture.exr";
}

ordered_json toJson(const Results& results, bool withNodes) {
  ordered_json scenes = ordered_json::array();
  for (const SceneResults& scene : results.scenes) {
    ordered_json rows = ordered_json::array();
    for (const Row& row : scene.rows) {
      ordered_json j = toJson(row);
      j["reasons"] = row.reasons;
      j["about"] = row.about;
      j["command"] = commandFor(results, scene, row);
      j["front"] = {{"total_full", row.frontTotalFull},
                    {"total_indirect", row.frontTotalIndirect},
                    {"frame_full", row.frontFrameFull},
                    {"frame_indirect", row.frontFrameIndirect}};
      if (!withNodes) {
        for (const char* part : {"nodes", "memory", "culled", "figures", "counts"}) j["cost"].erase(part);
      }
      rows.push_back(std::move(j));
    }
    scenes.push_back({{"name", scene.name},
                      {"source", scene.source},
                      {"camera", scene.camera},
                      {"triangles", scene.triangles},
                      {"reference", scene.truth},
                      {"reference_key", scene.truthKey},
                      {"reference_files", scene.truthFiles},
                      {"reference_share_of_a", scene.shareOfA},
                      {"floor", {{"full", scene.floorFull}, {"indirect", scene.floorIndirect}}},
                      {"notes", scene.notes},
                      {"rows", std::move(rows)}});
  }
  return {{"radivox", RADIVOX_VERSION}, {"device", results.device}, {"driver", results.driver},   {"host", results.host},
          {"width", results.width},     {"height", results.height}, {"bounces", results.bounces}, {"scenes", std::move(scenes)}};
}

void writeData(const Results& results) {
  std::string csv = csvHeading();
  for (const SceneResults& scene : results.scenes) {
    for (const Row& row : scene.rows) csv += printCsv(row, scene.floorFull, scene.floorIndirect);
  }
  image::writeFileAtomically(results.folder + "/data.csv", csv);
  image::writeFileAtomically(results.folder + "/data.json",
                             toJson(results, true).dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace radivox::report
