#include "samples/report/page.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "samples/report/plots.h"

namespace radivox::report {

namespace {

using nlohmann::ordered_json;

/// Pictures in the page are no wider; those in the folder are whole.
constexpr uint32_t kWidestThumbnail = 400;
constexpr size_t kMostFrontPictures = 6;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[1024];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string encodeBase64(const std::string& bytes) {
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[(word >> (18 - 6 * k)) & 63u] : '=';
  }
  return text;
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A picture of the folder as a tag that needs no file.
std::string embed(const Results& results, const std::string& name, const std::string& caption) {
  const std::string path = results.folder + "/pictures/" + name;
  const image::Image whole = image::readPng(path);
  const uint32_t k = (whole.width + kWidestThumbnail - 1) / kWidestThumbnail;
  std::string bytes;
  if (k > 1 && whole.width >= k && whole.height >= k) {
    const std::string small = results.folder + "/cache/thumbnail.png";
    image::writePng(small, image::blockMeans(whole, k));
    bytes = slurp(small);
  } else {
    bytes = slurp(path);
  }
  return "<div><img alt=\"" + escape(caption) + "\" src=\"data:image/png;base64," + encodeBase64(bytes) + "\"><span>" + escape(caption) +
         "</span></div>";
}

std::string trio(const Results& results, const SceneResults& scene, const Row& row) {
  std::string html = "<figure><figcaption>" + escape(row.setting.print()) + "</figcaption>";
  for (const std::string part : {"color", "indirect"}) {
    const ErrorFigures& e = part == "color" ? row.full : row.indirect;
    const std::string what = part == "color" ? "full picture" : "indirect irradiance";
    html += "<div class=\"trio\">" + embed(results, row.key + "." + part + ".png", what) +
            embed(results, "reference_" + scene.truthKey + "." + part + ".png", "reference") +
            embed(results, row.key + "." + part + "_error.png",
                  format("FLIP: mean %.3f; relative RMSE %.3g, bias %.3f", e.flip, e.relRmse, e.bias)) +
            "</div>";
  }
  return html + "</figure>\n";
}

std::string figureOf(const std::string& caption, const std::string& svg, const std::string& axes = "") {
  if (svg.empty()) return "";
  return "<figure" + (axes.empty() ? "" : " data-axes='" + escape(axes) + "'") + "><figcaption>" + escape(caption) + "</figcaption>" + svg +
         "</figure>\n";
}

std::string timePlot(const Results& results, const SceneResults& scene, TimeAxis axis, Part part) {
  const TimePlot plot = plotErrorAgainstTime(results, scene, axis, part);
  const ordered_json axes = {{"scene", scene.name},
                             {"time", axis == TimeAxis::Total ? "total" : "frame"},
                             {"part", part == Part::Full ? "full" : "indirect"},
                             {"x", {plot.xMin, plot.xMax}},
                             {"y", {plot.yMin, plot.yMax}},
                             {"left", plot.left},
                             {"right", plot.right},
                             {"top", plot.top},
                             {"bottom", plot.bottom}};
  const std::string caption = std::string(part == Part::Full ? "Full picture" : "Indirect light alone") +
                              (axis == TimeAxis::Total ? ", first picture" : ", every further frame");
  return figureOf(caption, plot.svg, axes.dump());
}

/// Methods as they are; the front from fast to exact, thinned; the path tracer's nearest in time to the middle of the front.
std::vector<const Row*> chooseForPictures(const SceneResults& scene) {
  std::vector<const Row*> chosen, front, traced;
  for (const Row& row : scene.rows) {
    if (row.isPathTracer()) {
      traced.push_back(&row);
    } else if (row.has(why::kMethod)) {
      chosen.push_back(&row);
    } else if (row.frontTotalIndirect) {
      front.push_back(&row);
    }
  }
  std::sort(front.begin(), front.end(), [](const Row* a, const Row* b) { return a->cost.totalMs() < b->cost.totalMs(); });
  const size_t count = std::min(front.size(), kMostFrontPictures);
  for (size_t i = 0; i < count; ++i) chosen.push_back(front[count > 1 ? i * (front.size() - 1) / (count - 1) : 0]);
  if (!traced.empty()) {
    chosen.push_back(traced.front());
    if (traced.size() > 1) chosen.push_back(traced.back());
  }
  return chosen;
}

std::string culledTable(const std::vector<const Row*>& methods) {
  std::string html;
  for (const Row* row : methods) {
    if (row->cost.culled.empty()) continue;
    html += "<details><summary>" + escape(row->setting.print()) + ": " + std::to_string(row->cost.culled.size()) +
            " nodes left out</summary><table><tr><th class=\"text\">node</th><th class=\"text\">why</th></tr>";
    for (const auto& [name, reason] : row->cost.culled) {
      html += "<tr><td class=\"text\">" + escape(name) + "</td><td class=\"text wrap\">" + escape(reason) + "</td></tr>";
    }
    html += "</table></details>\n";
  }
  return html.empty() ? "<p>Nothing.</p>" : html;
}

std::string sectionOf(const Results& results, const SceneResults& scene) {
  std::string html = "<h2>" + escape(scene.name) + "</h2>\n<p class=\"soft\">" + escape(scene.source) + ", " +
                     std::to_string(scene.triangles) + " triangles. Reference: " + escape(scene.truth) + ". ";
  html += scene.floorFull > 0
              ? format(
                    "Its own noise is %.3g of the mean in the full picture and %.3g in indirect light; intervals of 95 %% are drawn, and"
                    " errors are free of that noise.",
                    scene.floorFull, scene.floorIndirect)
              : std::string("It has one file: its own noise counts as error of every method, and how much that is nobody can tell.");
  html += "</p>\n<div class=\"plots\">\n";
  for (const TimeAxis axis : {TimeAxis::Total, TimeAxis::Frame}) {
    for (const Part part : {Part::Indirect, Part::Full}) html += timePlot(results, scene, axis, part);
  }
  html += "</div>\n";

  std::vector<const Row*> methods;
  for (const Row& row : scene.rows) {
    if (row.has(why::kMethod)) methods.push_back(&row);
  }
  std::string stages, nodes, memory;
  for (const Row* row : methods) {
    const std::string name = row->setting.print();
    stages += figureOf(name, plotStages(results, scene, *row));
    nodes += figureOf(name, plotNodes(results, scene, *row));
    memory += figureOf(name, plotMemory(results, scene, *row));
  }
  if (!stages.empty()) {
    html +=
        "<h3>Error by stage</h3>\n<p class=\"soft\">What each approximation costs in error: one parameter at a time at its most exact,"
        " all others as they are. A bar left of the dashed line: that stage makes error. Right of it: it hides another's.</p>\n"
        "<div class=\"plots\">" +
        stages + "</div>\n";
  }
  html +=
      "<h3>Pictures</h3>\n<p class=\"soft\">Result, reference, FLIP error <span class=\"heat\"></span> 0 to 1. Full-size pictures are in"
      " the folder <code>pictures</code>.</p>\n<div class=\"pictures\">\n";
  for (const Row* row : chooseForPictures(scene)) html += trio(results, scene, *row);
  html += "</div>\n<details open><summary>Time per node</summary><div class=\"plots\">" + nodes + "</div></details>\n";
  html += "<details><summary>Memory per resource</summary><div class=\"plots\">" + memory + "</div></details>\n";
  html += "<details><summary>What was left out, and why</summary>\n" + culledTable(methods);
  for (const std::string& note : scene.notes) html += "<p>" + escape(note) + "</p>\n";
  return html + "</details>\n";
}

std::string introOf(const Results& results) {
  return "<p class=\"soft\">Methods ran on " + escape(results.device) + " (" + escape(results.driver) + "), the path tracer on " +
         escape(results.host) + "; " + std::to_string(results.width) + "x" + std::to_string(results.height) + " pixels; the truth has " +
         escape(results.bounces) + (results.bounces == "1" ? " bounce" : " bounces") + ". Radivox " RADIVOX_VERSION ".</p>\n";
}

std::string notes() {
  return R"(<h2>How it was measured</h2>
<ul>
<li><b>Time.</b> Three things change in turn, several times over: the camera turns by half a degree, the lights change, the scene does. A
node's part of a frame is what it took when the camera moved; its part of a light what it took more than that when the lights changed;
its part of a scene the rest (less than half as much again is taken for noise). Medians; device timestamps, and the clock for nodes that work on the host. Overhead is what a frame takes
outside of nodes. The parts add up to what a first picture takes, pipelines and the driver's late compiling apart.</li>
<li><b>Error.</b> Relative RMSE is over the mean of the reference. Against a reference in two independent halves a, b the squared error
is the mean of (m - a)(m - b), which the reference's noise does not raise; intervals (95 %) come from how far the halves differ. PSNR and FLIP
are of pictures exposed so that the reference's 99th percentile is 1, and do see the reference's noise. Indirect light is
irradiance, where the reference has a surface that reflects.</li>
<li><b>Path tracer.</b> The same scene, camera and bounces; every sample count is a run of its own with other random numbers than the
reference. It begins anew with every frame; the scene's part is its hierarchy.</li>
<li><b>Settings.</b> Every graph and preset as it is; each parameter that trades time for quality one by one; each at its most exact; then what
lies beside the Pareto front. All figures are in <code>data.csv</code> and <code>data.json</code>.</li>
</ul>
)";
}

void replace(std::string& text, const std::string& placeholder, const std::string& value) {
  const size_t at = text.find(placeholder);
  if (at != std::string::npos) text.replace(at, placeholder.size(), value);
}

}  // namespace

void writePage(const Results& results) {
  std::string sections;
  for (const SceneResults& scene : results.scenes) sections += sectionOf(results, scene);
  std::string data = toJson(results, false).dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  // Within a script tag only "</" can end it.
  for (size_t at = data.find("</"); at != std::string::npos; at = data.find("</", at + 3)) data.replace(at, 2, "<\\/");
  std::string page = pageTemplate();
  replace(page, "{{data}}", data);
  replace(page, "{{intro}}", introOf(results));
  replace(page, "{{notes}}", notes());
  replace(page, "{{sections}}", sections);
  image::writeFileAtomically(results.folder + "/report.html", page);
}

}  // namespace radivox::report
