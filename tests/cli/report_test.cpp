// radivox report on a small scene: its figures are read back and held against each other, the pictures, and what other commands say.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "engine/image/compare.h"
#include "engine/image/image.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using CsvRow = std::map<std::string, std::string>;

std::vector<std::string> splitCsv(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<CsvRow> parseCsv(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = splitCsv(line);
  std::vector<CsvRow> rows;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = splitCsv(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    CsvRow row;
    for (size_t i = 0; i < std::min(cells.size(), names.size()); ++i) row[names[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

double number(const CsvRow& row, const std::string& name) { return std::stod(row.at(name)); }
bool isTracer(const CsvRow& row) { return row.at("method") == "path_tracer"; }

class ReportCommand : public CommandTest {
 protected:
  std::vector<std::string> report(std::vector<std::string> more) const {
    std::vector<std::string> all = {"report",   "builtin:cornell_point",
                                    "--out",    path("out"),
                                    "--size",   "48x32",
                                    "--cache",  path("c"),
                                    "--set",    "lights.point_shadow_resolution=128",
                                    "--method", path("small.json"),
                                    "--method", "direct"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void writePreset() const {
    write("small.json", R"({"graph": "clustered_voxel", "set": {"voxelize.resolution": 16, "visibility.rays": 16}})");
  }
  static std::string pictureOf(const CsvRow& row, const std::string& name) { return "out/pictures/" + row.at("key") + "." + name + ".png"; }

  void expectTimesAddUp(const std::vector<CsvRow>& rows, const json& data) const;
  void expectErrorsHangTogether(const std::vector<CsvRow>& rows) const;
  void expectPicturesSayTheSame(const std::vector<CsvRow>& rows, const std::string& reference) const;
  void expectFrontsAreFronts(const std::vector<CsvRow>& rows) const;
  void expectTracerConverges(const std::vector<CsvRow>& rows) const;
  void expectCommandsRepeatThePicture(const std::vector<CsvRow>& rows, const json& scene) const;
  void expectPageStandsAlone() const;
};

void ReportCommand::expectTimesAddUp(const std::vector<CsvRow>& rows, const json& data) const {
  const json& jsonRows = data.at("scenes").at(0).at("rows");
  ASSERT_EQ(jsonRows.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    const CsvRow& row = rows[i];
    SCOPED_TRACE(row.at("method") + " " + row.at("changes") + " " + row.at("samples"));
    double sum = 0;
    for (const char* part : {"scene_ms", "light_ms", "frame_ms", "overhead_ms"}) {
      EXPECT_GE(number(row, part), 0.0) << part;
      sum += number(row, part);
    }
    EXPECT_GT(number(row, "frame_ms"), 0.0);
    EXPECT_NEAR(number(row, "total_ms"), sum, 1e-9 * sum);
    // By the clock, which sees noise that medians of nodes do not: within a factor.
    EXPECT_LT(number(row, "total_ms"), 4 * number(row, "wall_scene_ms") + 20);
    EXPECT_GT(number(row, "total_ms"), 0.2 * number(row, "wall_scene_ms") - 20);
    EXPECT_GE(number(row, "repeats"), 1.0);
    EXPECT_EQ(jsonRows[i].at("key"), row.at("key"));
    if (isTracer(row)) continue;
    const json& cost = jsonRows[i].at("cost");
    double scene = 0, light = 0, frame = 0;
    uint64_t memory = 0;
    for (const auto& [name, node] : cost.at("nodes").items()) {
      scene += node.at("scene_ms").get<double>();
      light += node.at("light_ms").get<double>();
      frame += node.at("frame_ms").get<double>();
    }
    for (const auto& [name, resource] : cost.at("memory").items()) memory += resource.at("bytes").get<uint64_t>();
    EXPECT_NEAR(scene, number(row, "scene_ms"), 1e-6 * (1 + scene));
    EXPECT_NEAR(light, number(row, "light_ms"), 1e-6 * (1 + light));
    EXPECT_NEAR(frame, number(row, "frame_ms"), 1e-6 * (1 + frame));
    EXPECT_EQ(std::to_string(memory), row.at("memory_bytes"));
    EXPECT_GT(memory, 0u);
    // What depends on the light alone, and on the view alone.
    EXPECT_GT(cost.at("nodes").at("shadow_map").at("light_ms"), 0.0);
    EXPECT_EQ(cost.at("nodes").at("shadow_map").at("frame_ms"), 0.0);
    EXPECT_GT(cost.at("nodes").at("gbuffer").at("frame_ms"), 0.0);
    EXPECT_EQ(cost.at("nodes").at("gbuffer").at("light_ms"), 0.0);
    if (row.at("graph") == "clustered_voxel") {
      EXPECT_GT(cost.at("nodes").at("voxelize").at("scene_ms"), 0.0);
      EXPECT_EQ(cost.at("nodes").at("voxelize").at("light_ms"), 0.0);
      EXPECT_EQ(cost.at("nodes").at("voxelize").at("frame_ms"), 0.0);
      EXPECT_EQ(cost.at("nodes").at("bounce").at("frame_ms"), 0.0);
      EXPECT_TRUE(cost.at("culled").contains("inspect"));
    }
  }
}

void ReportCommand::expectErrorsHangTogether(const std::vector<CsvRow>& rows) const {
  for (const CsvRow& row : rows) {
    SCOPED_TRACE(row.at("method") + " " + row.at("changes") + " " + row.at("samples"));
    for (const std::string part : {"full_", "indirect_"}) {
      const double rmse = number(row, part + "rmse"), relative = number(row, part + "rel_rmse");
      EXPECT_LE(number(row, part + "rmse_low"), rmse);
      EXPECT_GE(number(row, part + "rmse_high"), rmse);
      EXPECT_LE(number(row, part + "bias_low"), number(row, part + "bias"));
      EXPECT_GE(number(row, part + "bias_high"), number(row, part + "bias"));
      // The same ratio everywhere: the mean of the reference.
      EXPECT_NEAR(relative / rmse, number(rows[0], part + "rel_rmse") / number(rows[0], part + "rmse"), 1e-6 * relative / rmse);
      EXPECT_GT(number(row, part + "floor"), 0.0);
      EXPECT_EQ(row.at(part + "floor"), rows[0].at(part + "floor"));
      EXPECT_GE(number(row, part + "flip_99"), number(row, part + "flip"));
      EXPECT_LE(number(row, part + "flip_99"), 1.0);
      if (!isTracer(row)) {
        EXPECT_GT(relative, number(row, part + "floor")) << "the reference is good enough to judge this";
      }
    }
    EXPECT_GE(number(row, "full_hdr_flip"), 0.0);
    if (row.at("method") == "direct") {
      EXPECT_EQ(number(row, "indirect_bias"), 0.0) << "no indirect light at all";
      EXPECT_GT(number(row, "indirect_rel_rmse"), 0.9);
    } else if (row.at("changes").find("request.bounces") != std::string::npos) {
      EXPECT_LT(number(row, "indirect_bias"), 1.0) << "light that bounced more often is missing";
    } else {
      EXPECT_NEAR(number(row, "indirect_bias"), 1.0, 0.3);
      EXPECT_LT(number(row, "indirect_rel_rmse_low"), 6.0);
    }
  }
}

void ReportCommand::expectPicturesSayTheSame(const std::vector<CsvRow>& rows, const std::string& reference) const {
  for (const std::string name : {"color", "indirect"}) {
    const image::Image truth = image::readPng(path("out/pictures/reference_" + reference + "." + name + ".png"));
    ASSERT_EQ(truth.width, 48u);
    ASSERT_EQ(truth.height, 32u);
    for (const CsvRow& row : rows) {
      const double psnr = image::psnr(truth, image::readPng(path(pictureOf(row, name))), 1.f);
      // Bytes instead of floats: their rounding is −59 dB.
      EXPECT_NEAR(psnr, number(row, (name == "color" ? "full_" : "indirect_") + std::string("psnr")), 0.15) << row.at("changes");
      const image::Image error = image::readPng(path(pictureOf(row, name + "_error")));
      EXPECT_EQ(error.width, 48u);
      EXPECT_EQ(image::meanOf(error) > 0, number(row, (name == "color" ? "full_" : "indirect_") + std::string("flip")) > 0);
    }
  }
}

void ReportCommand::expectFrontsAreFronts(const std::vector<CsvRow>& rows) const {
  for (const std::string time : {"total", "frame"}) {
    for (const std::string part : {"full", "indirect"}) {
      const std::string flag = "front_" + time + "_" + part;
      const auto x = [&](const CsvRow& row) {
        return time == "total" ? number(row, "total_ms") : number(row, "frame_ms") + number(row, "overhead_ms");
      };
      const auto y = [&](const CsvRow& row) { return number(row, part + "_rel_rmse"); };
      int onFront = 0;
      for (const CsvRow& row : rows) {
        bool dominated = isTracer(row);
        for (const CsvRow& other : rows) {
          if (isTracer(other) || &other == &row) continue;
          const bool noWorse = x(other) <= x(row) && y(other) <= y(row), better = x(other) < x(row) || y(other) < y(row);
          // Of equals the first is on the front.
          dominated = dominated || (noWorse && (better || &other < &row));
        }
        EXPECT_EQ(row.at(flag), dominated ? "0" : "1") << flag << " " << row.at("method") << " " << row.at("changes");
        onFront += row.at(flag) == "1";
      }
      EXPECT_GE(onFront, 2) << flag << ": no indirect light at all is faster, and worse";
    }
  }
}

void ReportCommand::expectTracerConverges(const std::vector<CsvRow>& rows) const {
  std::vector<const CsvRow*> traced;
  for (const CsvRow& row : rows) {
    if (isTracer(row)) traced.push_back(&row);
  }
  ASSERT_GE(traced.size(), 4u);
  for (size_t i = 0; i + 1 < traced.size(); ++i) {
    EXPECT_EQ(number(*traced[i + 1], "samples"), 2 * number(*traced[i], "samples"));
    for (const std::string part : {"full_rel_rmse", "indirect_rel_rmse"}) {
      // As 1/√N: √2 a step; a few very bright samples make it uneven.
      const double ratio = number(*traced[i], part) / number(*traced[i + 1], part);
      EXPECT_GT(ratio, 1.0) << part << " " << i;
      EXPECT_LT(ratio, 2.2) << part << " " << i;
    }
    EXPECT_NEAR(number(*traced[i], "full_bias"), 1.0, 0.1 / std::sqrt(number(*traced[i], "samples")) + 0.02);
  }
  EXPECT_GT(number(*traced.back(), "frame_ms"), number(*traced.front(), "frame_ms"));
}

void ReportCommand::expectCommandsRepeatThePicture(const std::vector<CsvRow>& rows, const json& scene) const {
  const auto files = scene.at("reference_files");
  ASSERT_EQ(files.size(), 2u);
  const double share = scene.at("reference_share_of_a");
  int repeated = 0;
  for (size_t i = 0; i < rows.size() && repeated < 3; ++i) {
    // Methods as they are, and the first swept row.
    if (isTracer(rows[i]) || (rows[i].at("reasons").find("method") == std::string::npos && repeated < 2)) continue;
    ++repeated;
    const std::string command = scene.at("rows").at(i).at("command");
    SCOPED_TRACE(command);
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    for (const char c : command + " ") {
      if (c == '\'') {
        quoted = !quoted;
      } else if (c == ' ' && !quoted) {
        words.push_back(word);
        word.clear();
      } else {
        word += c;
      }
    }
    ASSERT_EQ(words.at(0), "radivox");
    ASSERT_EQ(words.back(), "picture.exr");
    words.erase(words.begin());
    words.back() = path("again.exr");
    const bool hasIndirect = rows[i].at("method") != "direct";
    if (hasIndirect) words.insert(words.end(), {"--aov", "color,irradiance_indirect"});
    const CommandResult rendered = runRadivox(words);
    ASSERT_EQ(rendered.exitCode, 0) << rendered.err;
    for (const std::string part : {"full", "indirect"}) {
      if (part == "indirect" && !hasIndirect) continue;
      const CommandResult compared =
          runRadivox({"compare", files[0].get<std::string>() + "," + files[1].get<std::string>(), path("again.exr"), "--weights",
                      std::to_string(share) + "," + std::to_string(1 - share), "--layer", part == "full" ? "color" : "irradiance_indirect",
                      "--json", path("again.json")});
      ASSERT_EQ(compared.exitCode, 0) << compared.err;
      const json figures = json::parse(read("again.json"));
      const auto near = [&](const json& value, const std::string& name, double tolerance) {
        EXPECT_NEAR(value.get<double>(), number(rows[i], part + "_" + name), tolerance) << part << " " << name;
      };
      near(figures.at("rmse"), "rmse", 1e-5 * number(rows[i], part + "_rmse"));
      near(figures.at("bias"), "bias", 1e-5);
      near(figures.at("relmse"), "relmse", 1e-5);
      near(figures.at("psnr"), "psnr", 1e-4);
      near(figures.at("psnr_4x4"), "psnr_4x4", 1e-4);
      near(figures.at("flip").at("mean"), "flip", 1e-6);
      if (part == "full") near(figures.at("hdr_flip").at("mean"), "hdr_flip", 1e-6);
      near(figures.at("uncertainty").at("rmse_95")[1], "rmse_high", 1e-5 * number(rows[i], part + "_rmse"));
    }
  }
  EXPECT_GE(repeated, 2);
}

void ReportCommand::expectPageStandsAlone() const {
  const std::string html = read("out/report.html");
  const auto count = [&html](const std::string& what) {
    size_t found = 0;
    for (size_t at = html.find(what); at != std::string::npos; at = html.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_GE(count("<svg"), 4u + 2u + 2u) << "time plots, nodes and memory of two methods";
  EXPECT_EQ(count("<svg"), count("</svg>"));
  EXPECT_GE(count("src=\"data:image/png;base64,"), 12u);
  EXPECT_EQ(count("src="), count("src=\"data:image/png;base64,")) << "nothing comes from elsewhere";
  EXPECT_EQ(count("<link"), 0u);
  EXPECT_EQ(count("@import"), 0u);
  EXPECT_EQ(count("{{"), 0u) << "a placeholder was left";
  EXPECT_EQ(count("data-axes="), 4u);
  // Marks of one plot are not those of another.
  std::set<std::string> ids;
  for (size_t at = html.find(" id="); at != std::string::npos; at = html.find(" id=", at + 1)) {
    const char quote = html[at + 4];
    const std::string id = html.substr(at + 5, html.find(quote, at + 5) - at - 5);
    EXPECT_TRUE(ids.insert(id).second) << id;
  }
  // The figures that the finder works with are the page's own.
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const size_t begin = html.find(open) + open.size();
  const json data = json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  EXPECT_EQ(data.at("scenes").at(0).at("rows").size(), parseCsv(read("out/data.csv")).size());
}

TEST_F(ReportCommand, SlowFiguresHangTogether) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  writePreset();
  CommandSetup patient;
  patient.timeLimitSeconds = 110;
  const auto start = std::chrono::steady_clock::now();
  const CommandResult result = runRadivox(report({"--time-limit", "32", "--reference-error", "0.06"}), patient);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out, path("out") + "/report.html\n");
  // A step that has begun is finished, and a busy machine may be slow at that.
  EXPECT_LT(seconds, 32 + 16);

  const std::vector<CsvRow> rows = parseCsv(read("out/data.csv"));
  const json data = json::parse(read("out/data.json"));
  const json& scene = data.at("scenes").at(0);
  std::map<std::string, int> methods;
  std::set<std::string> keys;
  for (const CsvRow& row : rows) {
    ++methods[row.at("method")];
    EXPECT_TRUE(keys.insert(row.at("key")).second) << "nothing is measured twice";
  }
  EXPECT_GE(methods["small"], 2);
  EXPECT_GE(methods["direct"], 2);
  ASSERT_NO_FATAL_FAILURE(expectTimesAddUp(rows, data));
  ASSERT_NO_FATAL_FAILURE(expectErrorsHangTogether(rows));
  ASSERT_NO_FATAL_FAILURE(expectPicturesSayTheSame(rows, scene.at("reference_key")));
  ASSERT_NO_FATAL_FAILURE(expectFrontsAreFronts(rows));
  ASSERT_NO_FATAL_FAILURE(expectTracerConverges(rows));
  ASSERT_NO_FATAL_FAILURE(expectCommandsRepeatThePicture(rows, scene));
  ASSERT_NO_FATAL_FAILURE(expectPageStandsAlone());

  // Again: the reference and every row that was measured come from the folder, to the last digit, and the sweep goes on from there.
  const CommandResult again = runRadivox(report({"--time-limit", "5", "--reference-error", "0.06"}), patient);
  ASSERT_EQ(again.exitCode, 0) << again.err;
  const std::vector<CsvRow> more = parseCsv(read("out/data.csv"));
  EXPECT_EQ(json::parse(read("out/data.json")).at("scenes").at(0).at("reference_key"), scene.at("reference_key"));
  std::map<std::string, const CsvRow*> byKey;
  for (const CsvRow& row : more) byKey[row.at("key")] = &row;
  for (const CsvRow& row : rows) {
    // A setting found by the search is found again only where the search comes as far.
    if (row.at("reasons") == "search") continue;
    const auto found = byKey.find(row.at("key"));
    ASSERT_NE(found, byKey.end()) << row.at("method") << " " << row.at("changes");
    for (const char* name : {"total_ms", "wall_frame_ms", "full_rmse", "indirect_flip"}) EXPECT_EQ(found->second->at(name), row.at(name));
  }
}

TEST_F(ReportCommand, SlowInterruptionKeepsWhatWasMeasured) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  writePreset();
  CommandSetup setup;
  setup.signal = SIGINT;
  setup.signalAfterMs = 9000;
  const CommandResult stopped = runRadivox(report({"--reference-error", "0.3", "--method", "clustered_voxel_pixels"}), setup);
  ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
  EXPECT_EQ(stopped.err, "radivox: interrupted\n");
  EXPECT_FALSE(fs::exists(path("out/report.html")));
  std::map<std::string, std::string> kept;
  for (const auto& entry : fs::directory_iterator(path("out/cache"))) {
    EXPECT_EQ(entry.path().extension(), ".json") << "no half-written files";
    kept[entry.path().filename().string()] = read("out/cache/" + entry.path().filename().string());
  }
  ASSERT_GE(kept.size(), 3u);
  const CommandResult resumed =
      runRadivox(report({"--reference-error", "0.3", "--method", "clustered_voxel_pixels", "--time-limit", "4"}), {});
  ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
  for (const auto& [name, text] : kept) EXPECT_EQ(read("out/cache/" + name), text) << "measured once";
  EXPECT_GE(parseCsv(read("out/data.csv")).size(), kept.size());
}

/// Every file under `folder` is whole, by what its kind ends with, and none is a temporary one.
void expectWholeFiles(const std::string& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    SCOPED_TRACE(entry.path().string());
    const std::string kind = entry.path().extension();
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (kind == ".png") {
      EXPECT_NO_THROW(image::readPng(entry.path()));
    } else if (kind == ".json") {
      EXPECT_TRUE(json::accept(text));
    } else if (kind == ".svg") {
      EXPECT_NE(text.find("</svg>"), std::string::npos);
    } else if (kind == ".html") {
      EXPECT_NE(text.find("</html>"), std::string::npos);
    } else {
      EXPECT_TRUE(kind == ".csv" || kind == ".gp" || kind == ".log" || kind == ".state" || kind == ".exr" || kind == ".done") << kind;
    }
  }
}

// A disk that is full at the page, at a plot, and at the first file: one error, and no half file.
TEST_F(ReportCommand, SlowAFullDiskLeavesNoHalfFile) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  writePreset();
  std::vector<std::string> words = report({"--time-limit", "5", "--reference-error", "0.2"});
  std::replace(words.begin(), words.end(), std::string("48x32"), std::string("16x12"));  // plots are larger than pictures
  CommandSetup setup{.environment = {{"RADIVOX_PIPELINE_CACHE", ""}}};
  ASSERT_EQ(runRadivox(words, setup).exitCode, 0);
  const size_t pageBytes = read("out/report.html").size();
  size_t plotBytes = 0;
  for (const auto& entry : fs::directory_iterator(path("out/plots"))) plotBytes = std::max<size_t>(plotBytes, entry.file_size());
  ASSERT_GT(pageBytes, plotBytes + 1000);
  // The reference of the first run serves the others, until the last has to make its own. The table of figures comes before the plots, and
  // is larger than they are where there was time for many settings.
  const std::pair<size_t, const char*> cases[] = {{pageBytes - 1000, "report.html"}, {plotBytes - 100, "out/"}, {100, ".state"}};
  for (const auto& [largest, name] : cases) {
    SCOPED_TRACE(largest);
    if (largest == 100) fs::remove_all(path("c"));
    for (const char* file : {"out/report.html", "out/data.csv", "out/data.json"}) fs::remove(path(file));
    fs::remove_all(path("out/plots"));
    setup.largestFile = largest;
    const CommandResult result = runRadivox(words, setup);
    EXPECT_TRUE(result.exitCode == 2 || result.exitCode == 3) << result.exitCode << " " << result.err;
    EXPECT_EQ(result.err.rfind("radivox: ", 0), 0u) << result.err;
    EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(path("out/report.html")));
    expectWholeFiles(path("out"));
    if (fs::exists(path("c"))) expectWholeFiles(path("c"));
  }
}

TEST_F(ReportCommand, WhatIsWrongIsSaidBeforeTheWork) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  const std::string scene = "builtin:box";
  expectError({"report", "--out", path("out")}, 2, {"SCENE"});
  expectError({"report", scene}, 2, {"--out"});
  write("file", "");
  expectError({"report", scene, "--out", path("file")}, 2, {"file", "folder"});
  expectError({"report", scene, "--out", "/proc/report"}, 2, {"/proc/report", "folder"});
  for (const char* limit : {"0", "-3", "soon", "1s", "inf", "nan"}) {
    expectError({"report", scene, "--out", path("out"), "--time-limit", limit}, 2, {"--time-limit", limit});
  }
  for (const char* error : {"0", "x", "-1"}) {
    expectError({"report", scene, "--out", path("out"), "--reference-error", error}, 2, {"--reference-error", error});
  }
  expectError({"report", scene, "--out", path("out"), "--reference", path("none.exr")}, 2, {"none.exr", "no such file"});
  expectError({"report", scene, scene, "--out", path("out"), "--reference", path("file")}, 2, {"--reference", "one"});
  expectError({"report", scene, "--out", path("out"), "--weights", "1"}, 2, {"--weights"});
  expectError({"report", scene, "--out", path("out"), "--sise", "8x8"}, 2, {"'--sise'", "'--size'"});
  // Where there is no gnuplot there is no report.
  CommandSetup setup;
  setup.environment = {{"PATH", path("")}};
  expectError({"report", scene, "--out", path("out")}, 3, {"gnuplot-nox"}, setup);
}

TEST_F(ReportCommand, FilesAreAReferenceToo) {
  writePreset();
  const image::Image flat{8, 8, 3, std::vector<float>(192, 0.5f)};
  image::writeExr(path("a.exr"), {{"color", flat}, {"irradiance_indirect", flat}});
  image::writeExr(path("only.exr"), {{"color", flat}});
  fs::create_directory(path("c"));
  fs::create_directory(path("out"));
  for (const char* folder : {"out/pictures", "out/plots", "out/cache"}) fs::create_directory(path(folder));
  expectError(report({"--reference", path("a.exr")}), 2, {"a.exr", "8x8", "--size"});
  expectError(report({"--reference", path("only.exr")}), 2, {"only.exr", "irradiance_indirect"});
  write("b.png", "");
  expectError(report({"--reference", path("b.png")}), 2, {"b.png"});
}

}  // namespace

}  // namespace radivox::test
