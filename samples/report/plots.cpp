#include "samples/report/plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "samples/report/front.h"
#include "samples/report/gnuplot.h"

namespace radivox::report {

namespace {

constexpr const char* kAxisColor = "#444444";
/// Colours that most eyes tell apart, also where they are weak in red or green.
constexpr const char* kColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#8c564b"};
constexpr int kMarks[] = {7, 5, 9, 13, 11, 15};
constexpr const char* kSceneColor = "#9ecae1";
constexpr const char* kLightColor = "#fdae6b";
constexpr const char* kFrameColor = "#31a354";

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[1024];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// Within double quotes of gnuplot.
std::string quote(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '$' || c == '`') quoted += '\\';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + "\"";
}

std::string printTime(double ms) {
  return ms >= 1e4   ? format("%.0f s", ms * 1e-3)
         : ms >= 1e3 ? format("%.1f s", ms * 1e-3)
         : ms >= 10  ? format("%.0f ms", ms)
                     : format("%.2g ms", ms);
}

const ErrorFigures& errorsOf(const Row& row, Part part) { return part == Part::Full ? row.full : row.indirect; }
double timeOf(const Row& row, TimeAxis axis) { return axis == TimeAxis::Total ? row.cost.totalMs() : row.cost.everyFrameMs(); }
bool isOnFront(const Row& row, TimeAxis axis, Part part) {
  if (axis == TimeAxis::Total) return part == Part::Full ? row.frontTotalFull : row.frontTotalIndirect;
  return part == Part::Full ? row.frontFrameFull : row.frontFrameIndirect;
}

std::string fileName(const SceneResults& scene, const std::string& what) {
  std::string name = scene.name + "_" + what;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  }
  return name;
}

std::string commonStyle() {
  return format(
      "set border 3 lc rgb '%s'\nset tics nomirror scale 0.6 textcolor rgb '%s'\nset grid back lc rgb '#e4e4e4' lw 0.8\n"
      "set xlabel textcolor rgb '%s'\nset ylabel textcolor rgb '%s'\n",
      kAxisColor, kAxisColor, kAxisColor, kAxisColor);
}

/// Ticks at 1, 2 and 5 of every decade where there are few decades, else at every decade.
std::string logTicks(const char* axis, double min, double max) {
  std::string ticks;
  const bool few = std::log10(max / min) < 2.2;
  for (int decade = static_cast<int>(std::floor(std::log10(min))); decade <= static_cast<int>(std::ceil(std::log10(max))); ++decade) {
    for (const int digit : {1, 2, 5}) {
      if (digit != 1 && !few) continue;
      const double value = digit * std::pow(10.0, decade);
      if (value < min * 0.999 || value > max * 1.001) continue;
      ticks += format("%s\"%.10g\" %.10g", ticks.empty() ? "" : ", ", value, value);
    }
  }
  return format("set %stics (", axis) + ticks + ")\n";
}

struct Series {
  std::string method;
  std::string asIs, others;  // data blocks
};

}  // namespace

TimePlot plotErrorAgainstTime(const Results& results, const SceneResults& scene, TimeAxis axis, Part part) {
  constexpr int kWidth = 800, kHeight = 470;
  constexpr double kLeft = 0.095, kRight = 0.70, kBottom = 0.135, kTop = 0.955;
  TimePlot plot;
  plot.left = kLeft * kWidth;
  plot.right = kRight * kWidth;
  plot.top = (1 - kTop) * kHeight;
  plot.bottom = (1 - kBottom) * kHeight;
  const double floor = part == Part::Full ? scene.floorFull : scene.floorIndirect;
  double xMin = HUGE_VAL, xMax = 0, yMin = HUGE_VAL, yMax = 0;
  for (const Row& row : scene.rows) {
    const double x = timeOf(row, axis), y = errorsOf(row, part).relRmse;
    if (!(x > 0) || !std::isfinite(y)) continue;
    xMin = std::min(xMin, x);
    xMax = std::max(xMax, x);
    if (y > 0) yMin = std::min(yMin, y);
    yMax = std::max(yMax, y);
  }
  if (xMin > xMax) xMin = xMax = 1;
  if (yMin > yMax) yMin = yMax = 1;
  if (floor > 0) yMin = std::min(yMin, floor);
  plot.xMin = xMin / 1.6;
  plot.xMax = xMax * 1.6;
  plot.yMin = yMin / 1.5;
  plot.yMax = yMax * 1.5;

  std::vector<Series> all;
  std::string front, tracer;
  std::vector<const Row*> onFront, traced;
  for (const Row& row : scene.rows) {
    const ErrorFigures& e = errorsOf(row, part);
    if (!(timeOf(row, axis) > 0) || !std::isfinite(e.relRmse)) continue;
    const double least = plot.yMin * 1.0001;
    const std::string line = format("%.8g %.8g %.8g %.8g %u\n", timeOf(row, axis), std::max(e.relRmse, least),
                                    std::max(e.relRmseLow, least), std::max(e.relRmseHigh, least), row.setting.samples);
    if (row.isPathTracer()) {
      tracer += line;
      continue;
    }
    auto series = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.method == row.setting.method(); });
    if (series == all.end()) series = all.insert(all.end(), {row.setting.method(), "", ""});
    (row.setting.changes.empty() ? series->asIs : series->others) += line;
    if (isOnFront(row, axis, part)) onFront.push_back(&row);
  }
  std::sort(onFront.begin(), onFront.end(), [&](const Row* a, const Row* b) { return timeOf(*a, axis) < timeOf(*b, axis); });
  for (const Row* row : onFront)
    front += format("%.8g %.8g\n", timeOf(*row, axis), std::max(errorsOf(*row, part).relRmse, plot.yMin * 1.0001));
  // What was reached stays reached.
  if (!onFront.empty()) front += format("%.8g %.8g\n", plot.xMax, std::max(errorsOf(*onFront.back(), part).relRmse, plot.yMin * 1.0001));

  std::string script = commonStyle();
  script += format("set lmargin at screen %g\nset rmargin at screen %g\nset bmargin at screen %g\nset tmargin at screen %g\n", kLeft,
                   kRight, kBottom, kTop);
  script += "set logscale xy\n";
  script += format("set xrange [%.10g:%.10g]\nset yrange [%.10g:%.10g]\n", plot.xMin, plot.xMax, plot.yMin, plot.yMax);
  script += logTicks("x", plot.xMin, plot.xMax) + logTicks("y", plot.yMin, plot.yMax);
  script += std::string("set xlabel ") +
            (axis == TimeAxis::Total ? "'time of a first picture: scene + light + frame, ms'"
                                     : "'time of every further frame, camera moving, ms'") +
            "\n";
  script += std::string("set ylabel ") + (part == Part::Full ? "'relative RMSE of radiance'" : "'relative RMSE of indirect irradiance'") +
            " offset 0.5,0\n";
  script += format("set key at screen %g, screen %g left top Left reverse samplen 1.5 spacing 1.15 textcolor rgb '%s'\n", kRight + 0.012,
                   kTop + 0.01, kAxisColor);
  if (floor > 0) {
    script += format("set arrow from graph 0, first %.8g to graph 1, first %.8g nohead lc rgb '#999999' dt 3 lw 1.5 back\n", floor, floor);
    script += format(
        "set label 'noise of the reference' at graph 0.995, first %.8g right offset 0,0.5 textcolor rgb '#777777' font ',11'\n", floor);
  }
  std::string commands;
  const auto add = [&](const std::string& command) { commands += (commands.empty() ? "plot " : ", \\\n     ") + command; };
  int block = 0;
  const auto data = [&](const std::string& lines) {
    const std::string name = "$data" + std::to_string(block++);
    script += name + " << EOD\n" + lines + "EOD\n";
    return name;
  };
  if (!front.empty()) add(data(front) + " using 1:2 with steps lc rgb '#222222' lw 1.6 title 'best so far (Pareto front)'");
  size_t index = 0;
  for (const Series& s : all) {
    const char* color = kColors[index % std::size(kColors)];
    const int mark = kMarks[index % std::size(kMarks)];
    ++index;
    const std::string style = format("pt %d lc rgb '%s'", mark, color);
    if (!s.others.empty()) {
      add(data(s.others) + " using 1:2:3:4 with yerrorbars " + style + " ps 0.55 lw 0.8 " +
          (s.asIs.empty() ? "title " + quote(s.method) : "notitle"));
    }
    if (!s.asIs.empty()) add(data(s.asIs) + " using 1:2:3:4 with yerrorbars " + style + " ps 1.5 lw 1 title " + quote(s.method));
  }
  if (!tracer.empty()) {
    const std::string name = data(tracer);
    add(name + " using 1:2 with lines lc rgb '#000000' lw 1.2 dt 2 notitle");
    add(name + " using 1:2:3:4 with yerrorbars pt 6 ps 0.9 lc rgb '#000000' lw 1 title 'path tracer (samples a pixel)'");
    add(name + " using 1:2:(sprintf('%d', $5)) with labels offset 0.4,0.75 left font ',10' textcolor rgb '#000000' notitle");
  }
  if (commands.empty()) commands = "plot NaN notitle";
  const std::string what = std::string(axis == TimeAxis::Total ? "total" : "frame") + (part == Part::Full ? "_full" : "_indirect");
  plot.svg = runGnuplot(results.folder + "/plots", fileName(scene, what), kWidth, kHeight, script + commands + "\n");
  return plot;
}

namespace {

struct Bar {
  std::string label, note;
  std::vector<double> parts;
  double low = 0, high = 0;
};

struct BarStyle {
  std::string xLabel;
  std::vector<std::pair<std::string, const char*>> parts;  ///< title, colour
  double line = 0;                                         ///< a dashed line across; 0: none
  bool intervals = false;
  double room = 1.2;  ///< of the axis, for the notes beside the longest bar
};

/// Horizontal bars from the top, as many parts each as the style has.
std::string plotBars(const std::string& folder, const std::string& name, const std::vector<Bar>& bars, const BarStyle& style) {
  constexpr int kWidth = 800;
  const bool legend = style.parts.size() > 1;
  const int height = 64 + (legend ? 22 : 0) + 22 * static_cast<int>(bars.size());
  double most = 0;
  for (const Bar& bar : bars) most = std::max({most, std::accumulate(bar.parts.begin(), bar.parts.end(), 0.0), bar.high});
  if (!(most > 0)) most = 1;
  std::string script = commonStyle();
  script += "set border 1\nset grid xtics noytics\n";
  script += format("set lmargin at screen 0.30\nset rmargin at screen 0.98\nset bmargin at screen %g\nset tmargin at screen %g\n",
                   50.0 / height, 1.0 - (legend ? 30.0 : 8.0) / height);
  script += format("set xrange [0:%.10g]\nset yrange [%.10g:0.4]\n", most * style.room, static_cast<double>(bars.size()) + 0.6);
  script += "set xlabel " + quote(style.xLabel) + " offset 0,0.3\nset ytics scale 0 (";
  for (size_t i = 0; i < bars.size(); ++i) script += (i == 0 ? "" : ", ") + quote(bars[i].label) + " " + std::to_string(i + 1);
  script += ")\nset style fill solid 1 noborder\n";
  script += legend ? "set key at graph 1, screen 0.995 right top vertical maxrows 1 samplen 1 width 1\n" : "unset key\n";
  if (style.line > 0)
    script += format("set arrow from %.10g, graph 0 to %.10g, graph 1 nohead lc rgb '#222222' dt 2 lw 1.2 front\n", style.line, style.line);
  std::string commands;
  const auto add = [&](const std::string& command) { commands += (commands.empty() ? "plot " : ", \\\n     ") + command; };
  for (size_t part = 0; part < style.parts.size(); ++part) {
    std::string lines = "0 -9 0 0 -9.1 -9\n";  // out of sight, so that there is always a bar
    for (size_t i = 0; i < bars.size(); ++i) {
      const double from = std::accumulate(bars[i].parts.begin(), bars[i].parts.begin() + static_cast<std::ptrdiff_t>(part), 0.0);
      if (!(bars[i].parts[part] > 0)) continue;
      const double y = static_cast<double>(i + 1);
      lines += format("%.8g %.8g %.8g %.8g %.8g %.8g\n", from, y, from, from + bars[i].parts[part], y - 0.36, y + 0.36);
    }
    script += format("$part%zu << EOD\n", part) + lines + "EOD\n";
    add(format("$part%zu using 1:2:3:4:5:6 with boxxyerror lc rgb '%s' title ", part, style.parts[part].second) +
        quote(style.parts[part].first));
  }
  std::string notes, intervals;
  for (size_t i = 0; i < bars.size(); ++i) {
    const double end = std::max(std::accumulate(bars[i].parts.begin(), bars[i].parts.end(), 0.0), bars[i].high);
    notes += format("%.8g %zu ", end, i + 1) + quote(bars[i].note) + "\n";
    if (style.intervals) {
      intervals += format("%.8g %zu %.8g %.8g\n", std::accumulate(bars[i].parts.begin(), bars[i].parts.end(), 0.0), i + 1, bars[i].low,
                          bars[i].high);
    }
  }
  script += "$notes << EOD\n" + notes + "EOD\n";
  if (!intervals.empty()) {
    script += "$intervals << EOD\n" + intervals + "EOD\n";
    add("$intervals using 1:2:3:4 with xerrorbars pt 0 lc rgb '#222222' lw 1 notitle");
  }
  add("$notes using 1:2:3 with labels left offset 0.8,0 font ',11' textcolor rgb '#333333' notitle");
  return runGnuplot(folder, name, kWidth, height, script + commands + "\n");
}

}  // namespace

std::string plotStages(const Results& results, const SceneResults& scene, const Row& asIs) {
  std::vector<Bar> bars;
  const auto bar = [&](const Row& row, const std::string& label) {
    const ErrorFigures& e = row.indirect;
    const double change = e.relRmse - asIs.indirect.relRmse;
    std::string note = format("%.4f", e.relRmse);
    if (&row != &asIs) note += format(" (%+.4f)", change);
    bars.push_back({label, note + ", first picture " + printTime(row.cost.totalMs()), {e.relRmse}, e.relRmseLow, e.relRmseHigh});
  };
  bar(asIs, asIs.setting.method() + " as it is");
  for (const Row& row : scene.rows) {
    if (!row.has(why::kExact) || row.setting.graph != asIs.setting.graph || row.setting.preset != asIs.setting.preset) continue;
    std::string label = row.about;
    for (const auto& [name, value] : row.setting.changes) {
      if (name == row.about) label += "=" + value;
    }
    bar(row, label);
  }
  if (bars.size() < 2) return "";
  return plotBars(results.folder + "/plots", fileName(scene, "stages_" + asIs.setting.method()), bars,
                  {"relative RMSE of indirect irradiance, one parameter at a time at its most exact (95 % intervals)",
                   {{"error", "#7fb3d5"}},
                   asIs.indirect.relRmse,
                   true,
                   1.75});
}

std::string plotNodes(const Results& results, const SceneResults& scene, const Row& row) {
  std::vector<Bar> bars;
  for (const NodeCost& node : row.cost.nodes) {
    const double sum = node.sceneMs + node.lightMs + node.frameMs;
    bars.push_back({node.name, printTime(sum), {node.sceneMs, node.lightMs, node.frameMs}, 0, 0});
  }
  bars.push_back({"(outside of nodes)", printTime(row.cost.overheadMs), {0, 0, row.cost.overheadMs}, 0, 0});
  return plotBars(results.folder + "/plots", fileName(scene, "nodes_" + row.setting.method()), bars,
                  {"ms", {{"once a scene", kSceneColor}, {"once a light change", kLightColor}, {"every frame", kFrameColor}}, 0, false});
}

std::string plotMemory(const Results& results, const SceneResults& scene, const Row& row) {
  constexpr size_t kMost = 14;
  std::vector<MemoryCost> memory = row.cost.memory;
  std::stable_sort(memory.begin(), memory.end(), [](const MemoryCost& a, const MemoryCost& b) { return a.bytes > b.bytes; });
  std::vector<Bar> bars;
  double rest = 0;
  for (size_t i = 0; i < memory.size(); ++i) {
    const double mib = static_cast<double>(memory[i].bytes) / 1048576.0;
    if (i >= kMost) {
      rest += mib;
    } else {
      bars.push_back({memory[i].name, format("%.3g MiB%s", mib, memory[i].scratch ? ", scratch" : ""), {mib}, 0, 0});
    }
  }
  if (rest > 0) bars.push_back({format("(%zu others)", memory.size() - kMost), format("%.3g MiB", rest), {rest}, 0, 0});
  if (bars.empty()) return "";
  return plotBars(results.folder + "/plots", fileName(scene, "memory_" + row.setting.method()), bars,
                  {"MiB, largest resources of the graph", {{"memory", "#b8a1cf"}}, 0, false});
}

}  // namespace radivox::report
