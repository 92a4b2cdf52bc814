#include "engine/graph/left_out.h"

#include <algorithm>
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
  return {{Feature::AlphaMasks, "alpha masks", unless(traits.alphaMasked, "no material has one"),
           "the test of every fragment, shadow texel and piece of surface"},
          {Feature::SingleSides, "single-sided materials", unless(traits.singleSided, "every material is double-sided"),
           "the test which side is seen (with sides=gltf)"},
          {Feature::Textures, "textures", unless(traits.textureCount > 0, "no material has one"), "look-ups of colour and emission"},
          {Feature::PunctualLights, "punctual lights", unless(traits.punctualLightCount() > 0, "the scene has none"),
           "their exact shadow edges"},
          {Feature::Emitters, "emitters", unless(traits.emissiveTriangleCount > 0, "nothing in the scene emits"),
           "sums of emission; closed form and samples in direct light"},
          {Feature::Bounces, "indirect light", bounces, ""},
          {Feature::Matrix, "light between clusters", unless(request.bounces != 1 || traits.emittersByRays, "one bounce is asked for"), ""},
          {Feature::Readers, "pictures", "nobody asked for them", "their stores"}};
}

std::set<std::string> nodesOf(const Plan& plan) {
  std::set<std::string> names;
  for (const PlannedStep& step : plan.steps) names.insert(plan.nodeNames[step.node]);
  return names;
}

/// What `more` has and `base` has not.
LeftOut compare(const Plan& base, const Plan& more, const Counts& counts) {
  LeftOut entry;
  const std::set<std::string> nodes = nodesOf(base);
  for (const std::string& name : nodesOf(more)) {
    if (nodes.count(name) == 0) entry.nodes.push_back(name);
  }
  std::set<std::string> known;
  for (const PlannedResource& resource : base.resources) known.insert(resource.name);
  for (const PlannedResource& resource : more.resources) {
    if (resource.imported || known.count(resource.name) != 0) continue;
    if (std::find(entry.nodes.begin(), entry.nodes.end(), resource.name.substr(0, resource.name.find('.'))) == entry.nodes.end())
      entry.resources.push_back(resource.name);
    const auto bytes = resource.growable ? std::nullopt : detail::shapeBytes(resource.shape, counts);
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
    LeftOut entry = compare(base, compile(graph, {traits, input.request, input.capabilities, input.imports, input.knownCounts}), counts);
    traits.kept = input.traits.kept;
    entry.what = absence.what;
    entry.why = absence.why;
    entry.shaders = absence.shaders;
    if (!entry.nodes.empty() || !entry.resources.empty() || !entry.shaders.empty()) list.push_back(std::move(entry));
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
