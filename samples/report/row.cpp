#include "samples/report/row.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace radivox::report {

using nlohmann::json;
using nlohmann::ordered_json;

namespace {

/// JSON has no infinity: a PSNR of equal images is null.
double numberOr(const json& value, double other) { return value.is_number() ? value.get<double>() : other; }

ordered_json printErrors(const ErrorFigures& e) {
  return {{"bias", e.bias},           {"bias_95", {e.biasLow, e.biasHigh}},
          {"rmse", e.rmse},           {"rmse_95", {e.rmseLow, e.rmseHigh}},
          {"rel_rmse", e.relRmse},    {"rel_rmse_95", {e.relRmseLow, e.relRmseHigh}},
          {"relmse", e.relMse},       {"psnr", e.psnr},
          {"psnr_4x4", e.psnrBlocks}, {"flip", e.flip},
          {"flip_99", e.flip99},      {"hdr_flip", e.hdrFlip}};
}

ErrorFigures readErrors(const json& j) {
  constexpr double kInfinity = HUGE_VAL;
  ErrorFigures e;
  e.bias = numberOr(j.at("bias"), kInfinity);
  e.biasLow = numberOr(j.at("bias_95").at(0), kInfinity);
  e.biasHigh = numberOr(j.at("bias_95").at(1), kInfinity);
  e.rmse = j.at("rmse");
  e.rmseLow = j.at("rmse_95").at(0);
  e.rmseHigh = j.at("rmse_95").at(1);
  e.relRmse = numberOr(j.at("rel_rmse"), kInfinity);
  e.relRmseLow = numberOr(j.at("rel_rmse_95").at(0), kInfinity);
  e.relRmseHigh = numberOr(j.at("rel_rmse_95").at(1), kInfinity);
  e.relMse = numberOr(j.at("relmse"), kInfinity);
  e.psnr = numberOr(j.at("psnr"), kInfinity);
  e.psnrBlocks = numberOr(j.at("psnr_4x4"), kInfinity);
  e.flip = j.at("flip");
  e.flip99 = j.at("flip_99");
  e.hdrFlip = j.at("hdr_flip");
  return e;
}

ordered_json printCost(const Cost& c) {
  ordered_json nodes = ordered_json::object(), memory = ordered_json::object();
  for (const NodeCost& n : c.nodes) {
    nodes[n.name] = {{"type", n.type}, {"scene_ms", n.sceneMs}, {"light_ms", n.lightMs}, {"frame_ms", n.frameMs}};
  }
  for (const MemoryCost& m : c.memory) memory[m.name] = {{"bytes", m.bytes}, {"scratch", m.scratch}, {"meaning", m.meaning}};
  return {{"total_ms", c.totalMs()},
          {"scene_ms", c.sceneMs},
          {"light_ms", c.lightMs},
          {"frame_ms", c.frameMs},
          {"overhead_ms", c.overheadMs},
          {"prepare_ms", c.prepareMs},
          {"first_run_ms", c.firstRunMs},
          {"wall_scene_ms", c.wallSceneMs},
          {"wall_light_ms", c.wallLightMs},
          {"wall_frame_ms", c.wallFrameMs},
          {"repeats", c.repeats},
          {"nodes", std::move(nodes)},
          {"memory", std::move(memory)},
          {"device_bytes", c.deviceBytes},
          {"counts", c.counts},
          {"figures", c.figures},
          {"culled", c.culled}};
}

Cost readCost(const json& j) {
  Cost c;
  c.sceneMs = j.at("scene_ms");
  c.lightMs = j.at("light_ms");
  c.frameMs = j.at("frame_ms");
  c.overheadMs = j.at("overhead_ms");
  c.prepareMs = j.at("prepare_ms");
  c.firstRunMs = j.at("first_run_ms");
  c.wallSceneMs = j.at("wall_scene_ms");
  c.wallLightMs = j.at("wall_light_ms");
  c.wallFrameMs = j.at("wall_frame_ms");
  c.repeats = j.at("repeats");
  for (const auto& [name, n] : j.at("nodes").items()) {
    c.nodes.push_back({name, n.at("type"), n.at("scene_ms"), n.at("light_ms"), n.at("frame_ms")});
  }
  for (const auto& [name, m] : j.at("memory").items()) c.memory.push_back({name, m.at("meaning"), m.at("bytes"), m.at("scratch")});
  c.deviceBytes = j.at("device_bytes");
  c.counts = j.at("counts").get<std::map<std::string, uint64_t>>();
  for (const auto& [name, value] : j.at("figures").items()) c.figures[name] = numberOr(value, HUGE_VAL);
  c.culled = j.at("culled").get<std::map<std::string, std::string>>();
  return c;
}

std::string printChanges(const Setting& setting) {
  std::string text;
  for (const auto& [name, value] : setting.changes) text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
}

std::string printNumber(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (std::isnan(value)) return "nan";
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::string quoteCsv(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string Setting::method() const {
  if (samples > 0) return "path_tracer";
  const std::string& name = preset.empty() ? graph : preset;
  // A file goes by its name.
  return name.find('/') != std::string::npos || name.find(".json") != std::string::npos ? std::filesystem::path(name).stem().string()
                                                                                        : name;
}

std::string Setting::print() const {
  if (samples > 0) return "path_tracer " + std::to_string(samples) + " samples a pixel";
  const std::string changed = printChanges(*this);
  return method() + (changed.empty() ? "" : " " + changed);
}

bool Row::has(const std::string& reason) const { return std::find(reasons.begin(), reasons.end(), reason) != reasons.end(); }

ordered_json toJson(const Row& row) {
  ordered_json changes = ordered_json::array();
  for (const auto& [name, value] : row.setting.changes) changes.push_back({name, value});
  return {{"scene", row.scene},
          {"key", row.key},
          {"method", row.setting.method()},
          {"graph", row.setting.graph},
          {"preset", row.setting.preset},
          {"changes", std::move(changes)},
          {"bounces", row.setting.bounces},
          {"samples", row.setting.samples},
          {"cost", printCost(row.cost)},
          {"full", printErrors(row.full)},
          {"indirect", printErrors(row.indirect)}};
}

Row rowFromJson(const json& j) {
  Row row;
  row.scene = j.at("scene");
  row.key = j.at("key");
  row.setting.graph = j.at("graph");
  row.setting.preset = j.at("preset");
  for (const json& change : j.at("changes")) row.setting.changes.emplace_back(change.at(0), change.at(1));
  row.setting.bounces = j.at("bounces");
  row.setting.samples = j.at("samples");
  row.cost = readCost(j.at("cost"));
  row.full = readErrors(j.at("full"));
  row.indirect = readErrors(j.at("indirect"));
  return row;
}

std::string csvHeading() {
  std::string csv =
      "scene,method,graph,preset,changes,samples,reasons,about,total_ms,scene_ms,light_ms,frame_ms,overhead_ms,wall_scene_ms,wall_light_ms,"
      "wall_frame_ms,prepare_ms,first_run_ms,repeats,memory_bytes,device_bytes,voxels,faces,clusters";
  for (const std::string part : {"full", "indirect"}) {
    for (const char* name : {"bias", "bias_low", "bias_high", "rmse", "rmse_low", "rmse_high", "rel_rmse", "rel_rmse_low", "rel_rmse_high",
                             "relmse", "psnr", "psnr_4x4", "flip", "flip_99"}) {
      csv += "," + part + "_" + name;
    }
  }
  return csv + ",full_hdr_flip,full_floor,indirect_floor,front_total_full,front_total_indirect,front_frame_full,front_frame_indirect,key\n";
}

std::string printCsv(const Row& row, double floorFull, double floorIndirect) {
  const Cost& c = row.cost;
  std::string reasons;
  for (const std::string& reason : row.reasons) reasons += (reasons.empty() ? "" : " ") + reason;
  std::vector<std::string> cells = {row.scene,
                                    row.setting.method(),
                                    row.setting.graph,
                                    row.setting.preset,
                                    printChanges(row.setting),
                                    std::to_string(row.setting.samples),
                                    reasons,
                                    row.about};
  uint64_t memory = 0;
  for (const MemoryCost& m : c.memory) memory += m.bytes;
  for (const double value : {c.totalMs(), c.sceneMs, c.lightMs, c.frameMs, c.overheadMs, c.wallSceneMs, c.wallLightMs, c.wallFrameMs,
                             c.prepareMs, c.firstRunMs}) {
    cells.push_back(printNumber(value));
  }
  cells.push_back(std::to_string(c.repeats));
  cells.push_back(std::to_string(memory));
  cells.push_back(std::to_string(c.deviceBytes));
  for (const char* count : {"voxels", "faces", "clusters"}) {
    const auto found = c.counts.find(count);
    cells.push_back(found == c.counts.end() ? "" : std::to_string(found->second));
  }
  for (const ErrorFigures* e : {&row.full, &row.indirect}) {
    for (const double value : {e->bias, e->biasLow, e->biasHigh, e->rmse, e->rmseLow, e->rmseHigh, e->relRmse, e->relRmseLow,
                               e->relRmseHigh, e->relMse, e->psnr, e->psnrBlocks, e->flip, e->flip99}) {
      cells.push_back(printNumber(value));
    }
  }
  for (const double value : {row.full.hdrFlip, floorFull, floorIndirect}) cells.push_back(printNumber(value));
  for (const bool front : {row.frontTotalFull, row.frontTotalIndirect, row.frontFrameFull, row.frontFrameIndirect}) {
    cells.push_back(front ? "1" : "0");
  }
  cells.push_back(row.key);
  std::string line;
  for (size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : ",") + quoteCsv(cells[i]);
  return line + "\n";
}

}  // namespace radivox::report
