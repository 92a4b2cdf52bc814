#include "samples/report/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/error.h"
#include "engine/graph/plan.h"
#include "samples/cli/assets.h"

namespace radivox::report {

namespace {

constexpr double kMostEffort = 8;
constexpr std::string_view kPathTracerNode = "reference.path_trace";
const std::string kBounces = "request.bounces", kSupersample = "request.supersample";

/// Whether the scene has what a parameter of the lights is about.
bool isAboutScene(const std::string& lightParam, const scene::Traits& traits) {
  if (lightParam == "shadow_resolution") return traits.directionalLightCount + traits.spotLightCount > 0;
  if (lightParam == "point_shadow_resolution") return traits.pointLightCount > 0;
  return traits.emissiveTriangleCount > 0 && !traits.emittersByRays;
}

void addKnobs(const std::string& owner, const params::Table& table, bool live, Method& method) {
  for (const params::Param& param : table.all()) {
    const std::string name = owner + "." + param.name;
    method.values[name] = param.get();
    if (live && !param.sweep.empty()) method.knobs.push_back({name, param.sweep, param.exact, param.help});
  }
}

std::string valueOf(const Method& method, const Setting& setting, const std::string& name) {
  for (const auto& [changed, value] : setting.changes) {
    if (changed == name) return value;
  }
  const auto found = method.values.find(name);
  return found == method.values.end() ? "" : found->second;
}

/// "0.000001" and "1e-06" are the same.
bool sameValue(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char* endA = nullptr;
  char* endB = nullptr;
  const double x = std::strtod(a.c_str(), &endA), y = std::strtod(b.c_str(), &endB);
  return endA != a.c_str() && endB != b.c_str() && *endA == 0 && *endB == 0 && std::abs(x - y) <= 1e-6 * std::abs(x);
}

void change(const Method& method, Setting& setting, const std::string& name, const std::string& value) {
  auto& changes = setting.changes;
  changes.erase(std::remove_if(changes.begin(), changes.end(), [&](const Change& c) { return c.first == name; }), changes.end());
  if (!sameValue(value, valueOf(method, setting, name))) changes.emplace_back(name, value);
  std::sort(changes.begin(), changes.end());
}

/// A wider filter reads more faces, and those have to be marked before it.
void completeFilter(const Method& method, Setting& setting) {
  const std::string radius = valueOf(method, setting, "filter.radius"), passes = valueOf(method, setting, "filter.passes");
  if (radius.empty() || passes.empty() || method.values.count("mark.reach") == 0) return;
  const bool touched = std::any_of(setting.changes.begin(), setting.changes.end(),
                                   [](const Change& c) { return c.first == "filter.radius" || c.first == "filter.passes"; });
  if (touched) change(method, setting, "mark.reach", std::to_string(std::min(16, std::stoi(radius) * std::stoi(passes))));
}

Setting asIs(const Method& method) { return {method.graph, method.preset, {}, method.bounces, 0}; }

std::optional<Setting> turned(const Method& method, const Setting& from, const std::string& name, const std::string& value) {
  Setting setting = from;
  change(method, setting, name, value);
  completeFilter(method, setting);
  if (setting.changes == from.changes) return std::nullopt;
  return setting;
}

void addSweeps(const Method& method, std::vector<Trial>& trials) {
  for (const Knob& knob : method.knobs) {
    for (const std::string& value : knob.values) {
      if (auto setting = turned(method, asIs(method), knob.name, value)) trials.push_back({std::move(*setting), why::kSweep, knob.name});
    }
  }
}

cli::Options bare(const cli::Options& base, const std::string& graph, const std::string& preset) {
  cli::Options options = base;
  options.bounces.reset();  // a preset may have its own
  options.graph.reset();
  options.presets.clear();
  if (preset.empty()) {
    options.graph = graph;
  } else {
    options.presets = {preset};
  }
  options.aovs = "color";
  return options;
}

bool isFile(const std::string& name) { return name.find('/') != std::string::npos || name.find(".json") != std::string::npos; }

}  // namespace

std::vector<Method> findMethods(const cli::Options& options, const std::vector<std::string>& names, const scene::Scene& scene,
                                const gpu::Capabilities& capabilities, std::vector<std::string>& notes) {
  std::vector<std::pair<std::string, std::string>> candidates;  // graph, preset
  const auto isKnown = [](const std::vector<cli::Asset>& assets, const std::string& name) {
    return std::any_of(assets.begin(), assets.end(), [&](const cli::Asset& a) { return a.name == name; });
  };
  if (names.empty()) {
    for (const cli::Asset& graph : cli::graphs()) candidates.emplace_back(graph.name, "");
    for (const cli::Asset& preset : cli::presets()) candidates.emplace_back("", preset.name);
  }
  for (const std::string& name : names) {
    if (isKnown(cli::graphs(), name)) {
      candidates.emplace_back(name, "");
    } else if (isKnown(cli::presets(), name)) {
      candidates.emplace_back("", name);
    } else if (isFile(name)) {
      // A graph has nodes, a preset has none.
      const auto parsed = nlohmann::json::parse(cli::findGraph(name).text, nullptr, false);
      parsed.is_object() && parsed.contains("nodes") ? candidates.emplace_back(name, "") : candidates.emplace_back("", name);
    } else {
      std::vector<std::string> known;
      for (const cli::Asset& asset : cli::graphs()) known.push_back(asset.name);
      for (const cli::Asset& asset : cli::presets()) known.push_back(asset.name);
      cli::failUnknown("graph or preset", name, known);
    }
  }
  std::vector<Method> methods;
  for (const auto& [graphName, preset] : candidates) {
    cli::Options one = bare(options, graphName, preset);
    Method method;
    method.preset = preset;
    cli::Job probe;
    try {
      cli::prepareJob(one, false, probe);
    } catch (const Error& e) {
      if (std::string(e.what()).rfind("unknown AOV", 0) != 0) throw;
      notes.push_back((preset.empty() ? graphName : preset) + ": left out, for its graph has no AOV color");
      continue;
    }
    const bool traces = std::any_of(probe.graph.nodes().begin(), probe.graph.nodes().end(),
                                    [](const graph::Graph::Entry& entry) { return entry.node->type() == kPathTracerNode; });
    if (traces) {
      notes.push_back((preset.empty() ? graphName : preset) +
                      ": left out as a method, for it is the path tracer, which has a curve of its own");
      continue;
    }
    method.graph = preset.empty() ? graphName : probe.graphName;
    method.hasIndirect = probe.graph.aovs().count("irradiance_indirect") != 0;
    cli::Job job;
    if (method.hasIndirect) one.aovs = "color,irradiance_indirect";
    cli::prepareJob(one, false, job);
    // What this scene leaves out has nothing to turn.
    const scene::SceneShapes shapes = scene::describeShapes(scene, job.lights, job.request.width, job.request.height);
    const scene::Traits traits = scene::traitsFor(scene, job.lights);
    const graph::Plan plan = graph::compile(job.graph, {traits, job.request, capabilities, shapes.imports, shapes.counts});
    std::set<std::string> culled;
    for (const graph::CulledNode& node : plan.culled) culled.insert(node.name);
    for (const graph::Graph::Entry& entry : job.graph.nodes()) {
      addKnobs(entry.name, entry.node->params(), culled.count(entry.name) == 0, method);
    }
    Method lights;
    addKnobs("lights", job.lightParams, true, lights);
    method.values.insert(lights.values.begin(), lights.values.end());
    for (const Knob& knob : lights.knobs) {
      if (isAboutScene(knob.name.substr(knob.name.find('.') + 1), traits)) method.knobs.push_back(knob);
    }
    const bool wantsAll = job.request.bounces == scene::kAllBounces;
    if (wantsAll && options.bounces && *options.bounces != "all") method.bounces = *options.bounces;
    method.values[kBounces] = !wantsAll ? std::to_string(job.request.bounces) : method.bounces.empty() ? "all" : method.bounces;
    method.values[kSupersample] = std::to_string(job.supersample);
    if (method.hasIndirect && wantsAll) {
      const std::string& most = method.values[kBounces];
      Knob knob{kBounces, {}, "", "indirect bounces"};
      for (const char* fewer : {"1", "2", "4"}) {
        if (most == "all" || std::stoul(fewer) < std::stoul(most)) knob.values.push_back(fewer);
      }
      knob.values.push_back(most);
      method.knobs.push_back(std::move(knob));
    }
    method.knobs.push_back({kSupersample, {"1", "2"}, "3", "each pixel is the mean of K x K"});
    methods.push_back(std::move(method));
  }
  return methods;
}

std::vector<Trial> planTrials(const std::vector<Method>& methods) {
  std::vector<Trial> trials;
  for (const Method& method : methods) trials.push_back({asIs(method), why::kMethod, ""});
  for (const Method& method : methods) {
    if (!method.preset.empty()) continue;
    for (const Knob& knob : method.knobs) {
      if (knob.exact.empty()) continue;
      const double from = std::strtod(method.values.at(knob.name).c_str(), nullptr), to = std::strtod(knob.exact.c_str(), nullptr);
      const double effort = from > 0 && to > from ? std::min(to / from * to / from, kMostEffort) : 1.0;
      if (auto setting = turned(method, asIs(method), knob.name, knob.exact)) {
        trials.push_back({std::move(*setting), why::kExact, knob.name, effort});
      }
    }
  }
  for (const Method& method : methods) {
    if (method.preset.empty()) addSweeps(method, trials);
  }
  for (const Method& method : methods) {
    if (!method.preset.empty()) addSweeps(method, trials);
  }
  return trials;
}

std::vector<Trial> neighbours(const std::vector<Method>& methods, const Setting& setting) {
  std::vector<Trial> trials;
  const auto method =
      std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.graph == setting.graph && m.preset == setting.preset; });
  if (method == methods.end()) return trials;
  for (const Knob& knob : method->knobs) {
    const std::string now = valueOf(*method, setting, knob.name);
    const auto at = std::find_if(knob.values.begin(), knob.values.end(), [&](const std::string& v) { return sameValue(v, now); });
    std::vector<std::string> beside;
    if (at == knob.values.end()) {
      beside = {knob.values.back()};  // off the ladder (an exact value): its dearest step is the nearest
    } else {
      if (at != knob.values.begin()) beside.push_back(*(at - 1));
      if (at + 1 != knob.values.end()) beside.push_back(*(at + 1));
    }
    for (const std::string& value : beside) {
      if (auto next = turned(*method, setting, knob.name, value)) trials.push_back({std::move(*next), why::kSearch, knob.name});
    }
  }
  return trials;
}

cli::Options optionsFor(const cli::Options& base, const Method& method, const Setting& setting) {
  cli::Options options = bare(base, setting.graph, setting.preset);
  options.bounces = method.values.at(kBounces);
  if (method.hasIndirect) options.aovs = "color,irradiance_indirect";
  for (const auto& [name, value] : setting.changes) {
    if (name == kBounces) {
      options.bounces = value;
    } else if (name == kSupersample) {
      options.supersample = value;
    } else {
      options.sets.push_back(name + "=" + value);
    }
  }
  return options;
}

}  // namespace radivox::report
