#include "engine/graph/left_out.h"

#include <algorithm>
#include <map>
#include <set>

#include "engine/graph/plan_print.h"

namespace radivox::graph {

namespace {

using scene::Feature;

struct Absence {
  Feature feature;
  const char* what;
  std::string why;  ///< empty: it is there
  const char* shaders;
};

std::vector<Absence> listAbsences(const scene::Traits& traits, const scene::Request& request) {
  const auto unless = [](bool there, const char* why) { return std::string(there ? "" : why); };
  const char* nothingBounces = traits.whyNothingBounces();
  std::string bounces;
  if (!traits.sky) bounces = !request.wantsIndirect() ? "0 bounces are asked for" : nothingBounces != nullptr ? nothingBounces : "";
  static constexpr const char* kSole[] = {"the only light is directional", "the only light is a point", "the only light is a spot"};
  const std::string sole = traits.soleLight() == scene::kManyLights ? "" : kSole[traits.soleLight()];
  std::string dark;
  if (traits.darkViewCount > 0)
    dark = "no face is in " + std::to_string(traits.darkViewCount) + " of " + std::to_string(traits.shadowViewCount) + " views";
  return {{Feature::AlphaMasks, "alpha masks", unless(traits.alphaMasked, "no material has one"),
           "the test of every fragment, shadow texel and piece of surface"},
          {Feature::SingleSides, "single-sided materials", unless(traits.singleSided, "every material is double-sided"),
           "the test which side is seen (with sides=gltf)"},
          {Feature::Textures, "textures", unless(traits.textureCount > 0, "no material has one"), "look-ups of colour and emission"},
          {Feature::PunctualLights, "punctual lights", unless(traits.punctualLightCount() > 0, "the scene has none"),
           "their exact shadow edges"},
          {Feature::Emitters, "emitters", unless(traits.emissiveTriangleCount > 0, "nothing in the scene emits"),
           "sums of emission; closed form and samples in direct light"},
          {Feature::Sky, "sky", unless(traits.sky, "the scene has none"), "its light on near surfaces"},
          {Feature::Bounces, "indirect light", bounces, ""},
          {Feature::Matrix, "light between clusters", unless(request.bounces != 1 || traits.emittersByRays, "one bounce is asked for"), ""},
          {Feature::OtherLights, "other lights", sole, "the loop over lights, and what lights of other kinds do"},
          {Feature::DarkViews, "shadow maps where no face is", dark, ""},
          {Feature::Readers, "pictures", "nobody asked for them", "their stores"}};
}

std::set<std::string> nodesOf(const Plan& plan) {
  std::set<std::string> names;
  for (const PlannedStep& step : plan.steps) names.insert(plan.nodeNames[step.node]);
  return names;
}

/// What `more` has and `base` has not.
LeftOut compare(const Plan& base, const Counts& baseCounts, const Plan& more, const Counts& counts) {
  LeftOut entry;
  const auto bytesOf = [](const PlannedResource& resource, const Counts& known) {
    return resource.growable ? std::nullopt : detail::shapeBytes(resource.shape, known);
  };
  const std::set<std::string> nodes = nodesOf(base);
  for (const std::string& name : nodesOf(more)) {
    if (nodes.count(name) == 0) entry.nodes.push_back(name);
  }
  std::map<std::string, uint64_t> known;  // bytes by name
  for (const PlannedResource& resource : base.resources) known[resource.name] = bytesOf(resource, baseCounts).value_or(0);
  for (const PlannedResource& resource : more.resources) {
    if (resource.imported) continue;
    const auto bytes = bytesOf(resource, counts);
    if (const auto there = known.find(resource.name); there != known.end()) {  // no larger, or larger
      entry.bytes += std::max(bytes.value_or(0), there->second) - there->second;
      continue;
    }
    if (std::find(entry.nodes.begin(), entry.nodes.end(), resource.name.substr(0, resource.name.find('.'))) == entry.nodes.end())
      entry.resources.push_back(resource.name);
    entry.bytes += bytes.value_or(0);
    entry.open |= !bytes;
  }
  return entry;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::vector<LeftOut> listLeftOut(const Graph& graph, const CompileInput& input, const Counts& counts) {
  std::vector<LeftOut> list;
  scene::Traits traits = input.traits;
  const Plan base = compile(graph, input);
  for (const Absence& absence : listAbsences(traits, input.request)) {
    if (absence.why.empty() || traits.keeps(absence.feature)) continue;
    traits.kept = input.traits.kept | 1u << static_cast<uint32_t>(absence.feature);
    Counts keptCounts = counts;
    if (absence.feature == Feature::DarkViews) {
      keptCounts["shadow_resolution"] = traits.wholeShadowSide;
      keptCounts["shadow_layers"] = traits.wholeShadowLayers;
    }
    LeftOut entry =
        compare(base, counts, compile(graph, {traits, input.request, input.capabilities, input.imports, input.knownCounts}), keptCounts);
    traits.kept = input.traits.kept;
    entry.what = absence.what;
    entry.why = absence.why;
    entry.shaders = absence.shaders;
    if (!entry.nodes.empty() || entry.bytes > 0 || entry.open || !entry.shaders.empty()) list.push_back(std::move(entry));
  }
  compile(graph, input);  // nodes remember what they declared last
  return list;
}

std::string printLeftOut(const std::vector<LeftOut>& list) {
  std::string text;
  for (const LeftOut& entry : list) {
    text += "  " + entry.what + " (" + entry.why + ")";
    std::string cost;
    const auto add = [&cost](const std::string& part) { cost += (cost.empty() ? "" : "; ") + part; };
    if (!entry.nodes.empty()) add("nodes " + join(entry.nodes));
    if (!entry.resources.empty()) add("resources " + join(entry.resources));
    if (entry.bytes > 0 || entry.open) add(std::string(entry.open ? "at least " : "") + std::to_string(entry.bytes) + " B");
    if (!entry.shaders.empty()) add("in shaders " + entry.shaders);
    text += cost.empty() ? "\n" : ": would have cost " + cost + "\n";
  }
  return text.empty() ? "" : "not needed\n" + text;
}

}  // namespace radivox::graph
