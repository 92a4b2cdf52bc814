#include "samples/cli/job.h"

#include <map>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "modules/modules.h"
#include "samples/cli/assets.h"

namespace radivox::cli {

namespace {

using nlohmann::json;

json parsePreset(const Source& preset) {
  // Copies and prints of JSON recurse: nesting beyond what a preset needs could end the stack.
  const auto limitDepth = [&preset](int depth, json::parse_event_t, json&) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) throw Error(ErrorCode::BadInput, preset.source + ": nested too deeply; write {\"set\": {\"node.param\": value}}");
    return true;
  };
  try {
    json parsed = json::parse(preset.text, limitDepth);
    if (parsed.is_object()) return parsed;
  } catch (const json::parse_error& e) {
    throw Error(ErrorCode::BadInput, preset.source + ": byte " + std::to_string(e.byte) + ": not JSON; mend the file");
  } catch (const json::exception&) {
    throw Error(ErrorCode::BadInput, preset.source + ": holds a number that is too large; mend the file");
  }
  throw Error(ErrorCode::BadInput, preset.source + ": not a JSON object; write {\"set\": {\"node.param\": value}}");
}

constexpr uint32_t kMostSupersample = 8;

/// "request": {"bounces": 1} or {"bounces": "all"}; {"supersample": 2}.
void applyRequest(const Source& preset, const json& parsed, Job& job) {
  scene::Request& request = job.request;
  const auto found = parsed.find("request");
  if (found == parsed.end()) return;
  if (!found->is_object()) throw Error(ErrorCode::BadInput, preset.source + ": request: not an object; write {\"bounces\": 1}");
  for (const auto& [key, value] : found->items()) {
    if (key == "supersample") {
      if (!value.is_number_unsigned() || value.get<uint64_t>() < 1 || value.get<uint64_t>() > kMostSupersample)
        throw Error(ErrorCode::BadInput, preset.source + ": request.supersample: not a whole number from 1 to " +
                                             std::to_string(kMostSupersample) + "; each pixel is the mean of so many squared");
      job.supersample = value.get<uint32_t>();
      continue;
    }
    if (key != "bounces")
      throw Error(ErrorCode::BadInput, preset.source + ": request." + key + ": unknown; there are bounces and supersample");
    if (value.is_number_unsigned() && value.get<uint64_t>() < scene::kAllBounces) {
      request.bounces = static_cast<uint32_t>(value.get<uint64_t>());
    } else if (value.is_string() && value.get<std::string>() == "all") {
      request.bounces = scene::kAllBounces;
    } else {
      throw Error(ErrorCode::BadInput, preset.source + ": request.bounces: not a number of bounces; write a whole number or \"all\"");
    }
  }
}

void applySetting(const std::string& setting, Job& job) {
  const size_t equals = setting.find('=');
  const size_t dot = setting.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw Error(ErrorCode::BadInput, "--set '" + setting + "': give node.param=value, as in voxelize.resolution=64");
  }
  const std::string name = setting.substr(0, equals), value = setting.substr(equals + 1);
  if (name.substr(0, dot) == "lights") {
    job.lightParams.set("lights", name.substr(dot + 1), value);
  } else {
    job.graph.set(name, value);
  }
}

/// Black by definition: what light that never bounced adds to light that did.
bool isIndirect(const std::string& aov) { return aov == "indirect" || aov == "irradiance_indirect"; }

/// A graph file without a table of AOVs still has a picture: its first output.
std::map<std::string, std::string> aovTable(const graph::Graph& graph) {
  std::map<std::string, std::string> table = graph.aovs();
  if (table.empty() && !graph.outputs().empty()) table["color"] = graph.outputs().front().print();
  return table;
}

Aov resolveAov(const std::string& name, const std::map<std::string, std::string>& table, const Job& job) {
  const auto found = table.find(name);
  if (found == table.end()) {
    std::vector<std::string> names;
    for (const auto& [known, endpoint] : table) names.push_back(known);
    failUnknown("AOV of graph " + job.graphName, name, names);
  }
  Aov aov{name, found->second, -1};
  const size_t length = aov.endpoint.size();
  const size_t channel =
      length > 2 && aov.endpoint[length - 2] == '.' ? std::string("xyzw").find(aov.endpoint[length - 1]) : std::string::npos;
  if (channel != std::string::npos) {
    aov.channel = static_cast<int>(channel);
    aov.endpoint.resize(length - 2);
  }
  if (job.request.bounces == 0 && isIndirect(name)) aov.endpoint.clear();
  return aov;
}

}  // namespace

bool isIrradiance(const std::string& aov) { return aov == "irradiance_direct" || aov == "irradiance_indirect"; }

params::Table lightTable(scene::LightOptions& lights) {
  using params::Invalidates;
  return params::Table({
      params::swept(params::number("shadow_resolution", &lights.shadowResolution, {16, 8192},
                                   "texels a side of a directional or spot light's map", Invalidates::Plan),
                    {"512", "1024", "2048", "4096"}, "4096"),
      params::swept(params::number("point_shadow_resolution", &lights.pointShadowResolution, {16, 8192},
                                   "texels a side of a point light's cube face", Invalidates::Plan),
                    {"256", "512", "1024", "2048"}, "2048"),
      params::swept(params::number("emitter_samples", &lights.emitterSamples, {0, 4096},
                                   "points on emissive triangles, by power; 0: emitters light through voxel rays only", Invalidates::Plan),
                    {"8", "16", "32", "64"}, "128"),
      params::swept(params::number("emitter_shadow_resolution", &lights.emitterShadowResolution, {16, 4096},
                                   "texels a side of an emitter sample's maps", Invalidates::Plan),
                    {"64", "128", "256", "512"}, "512"),
  });
}

void fillRegistry(const Options& options, plugin::Registry& registry) {
  registerModules(registry);
  for (const std::string& module : options.modules) registry.load(module);
}

void prepareJob(const Options& options, bool wantsDisplay, Job& job, const char* fallbackGraph) {
  job.size = parseSize(options.size);
  const std::vector<std::string> aovNames = parseList("--aov", options.aovs);
  job.request.aovs = {aovNames.begin(), aovNames.end()};
  job.lightParams = lightTable(job.lights);
  job.lights.fixed = true;
  job.lights.kept = options.keepAll ? scene::kKeepAll : 0;
  fillRegistry(options, job.registry);

  std::vector<Source> presets;
  std::optional<std::string> graphName = options.graph;
  std::vector<std::string> presetNames = options.presets;
  if (presetNames.empty() && !options.graph && std::string_view(fallbackGraph) == kPictureGraph) presetNames = {kDefaultPreset};
  for (const std::string& name : presetNames) {
    presets.push_back(findPreset(name));
    const json parsed = parsePreset(presets.back());
    applyRequest(presets.back(), parsed, job);
    const auto graph = parsed.find("graph");
    if (!graphName && graph != parsed.end() && graph->is_string()) graphName = graph->get<std::string>();
    job.presetNames.push_back(presets.back().name);
  }
  if (!options.supersample.empty()) job.supersample = parseWhole("--supersample", options.supersample, 1, kMostSupersample);
  job.request.width = job.size.width * job.supersample;
  job.request.height = job.size.height * job.supersample;
  if (job.request.width > kMaxSide || job.request.height > kMaxSide) {
    throw Error(ErrorCode::BadInput, "--supersample " + std::to_string(job.supersample) + " of --size " + options.size + ": sides beyond " +
                                         std::to_string(kMaxSide) + " pixels; lower one of them");
  }
  if (options.bounces) job.request.bounces = parseBounces(*options.bounces);

  const Source source = findGraph(graphName.value_or(fallbackGraph));
  job.graphName = source.name;
  job.graph = graph::Graph::fromJson(source.text, source.source, job.registry);
  for (const Source& preset : presets) job.graph.applyPreset(preset.text, preset.source);
  for (const std::string& setting : options.sets) applySetting(setting, job);

  const auto table = aovTable(job.graph);
  std::vector<std::string> endpoints;
  for (const std::string& name : aovNames) {
    job.aovs.push_back(resolveAov(name, table, job));
    if (!job.aovs.back().endpoint.empty()) endpoints.push_back(job.aovs.back().endpoint);
    if (isIrradiance(name) && job.supersample > 1 && !job.albedo && table.count("albedo") != 0) {
      job.albedo = resolveAov("albedo", table, job);
      endpoints.push_back(job.albedo->endpoint);
    }
  }
  if (wantsDisplay && job.request.aovs.count("color") != 0 && job.supersample == 1 && table.count("display") != 0) {
    job.displayEndpoint = resolveAov("display", table, job);
    endpoints.push_back(job.displayEndpoint->endpoint);
  }
  if (endpoints.empty()) return;  // nothing but black: the graph's own outputs stay, so that the plan has something to plan
  job.graph.clearOutputs();
  for (const std::string& endpoint : endpoints) job.graph.output(endpoint);
}

const graph::Graph::Entry& findVisibility(const Job& job) {
  constexpr std::string_view kVisibility = "clustered_voxel.visibility";
  for (const graph::Graph::Entry& entry : job.graph.nodes()) {
    if (entry.node->type() == kVisibility) return entry;
  }
  throw Error(ErrorCode::BadInput,
              "--graph " + job.graphName + " casts no voxel rays; give one with a " + std::string(kVisibility) + " node");
}

}  // namespace radivox::cli
