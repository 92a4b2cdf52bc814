#include "bindings/c/handles.h"
#include "modules/modules.h"

using namespace radivox;
using c::guarded;

namespace {

/// Node and parameter of a flat index; null past the end.
const params::Param* findParam(const graph::Graph& graph, uint32_t index, const char** node) {
  for (const graph::Graph::Entry& entry : graph.nodes()) {
    const auto& all = entry.node->params().all();
    if (index < all.size()) {
      *node = entry.name.c_str();
      return &all[index];
    }
    index -= static_cast<uint32_t>(all.size());
  }
  return nullptr;
}

graph::Graph& requireUnused(RadivoxGraph* graph) {
  if (c::require(graph, "graph").state->hasRenderer) {
    throw Error(ErrorCode::BadInput, "the graph is planned already; change nodes, edges and outputs before radivoxCreateRenderer");
  }
  return graph->state->graph;
}

}  // namespace

RadivoxResult radivoxCreateGraph(const RadivoxGraphInfo* info, RadivoxGraph** graph) {
  return guarded([&] {
    c::require(graph, "graph");
    const RadivoxGraphInfo given = c::takeStruct(info, "info");
    auto state = std::make_shared<c::GraphState>();
    registerModules(state->registry);
    for (uint32_t i = 0; i < given.moduleCount; ++i) {
      state->registry.load(c::requireText((&c::require(given.modules, "info->modules"))[i], "info->modules[i]"));
    }
    const std::string name = given.name != nullptr ? given.name : "graph";
    state->graph = graph::Graph::fromJson(c::requireText(given.json, "info->json"), name, state->registry);
    *graph = new RadivoxGraph{std::move(state), {}, {}};
  });
}

void radivoxDestroyGraph(RadivoxGraph* graph) { delete graph; }

RadivoxResult radivoxReplaceByImports(RadivoxGraph* graph, const char* node, const char* import) {
  return guarded([&] { requireUnused(graph).replaceByImports(c::requireText(node, "node"), c::requireText(import, "import")); });
}

RadivoxResult radivoxAddOutput(RadivoxGraph* graph, const char* endpoint) {
  return guarded([&] { requireUnused(graph).output(c::requireText(endpoint, "endpoint")); });
}

RadivoxResult radivoxClearOutputs(RadivoxGraph* graph) {
  return guarded([&] { requireUnused(graph).clearOutputs(); });
}

RadivoxResult radivoxSetParameter(RadivoxGraph* graph, const char* nodeParam, const char* value) {
  return guarded(
      [&] { c::require(graph, "graph").state->graph.set(c::requireText(nodeParam, "nodeParam"), c::requireText(value, "value")); });
}

RadivoxResult radivoxGetParameter(RadivoxGraph* graph, const char* nodeParam, const char** value) {
  return guarded([&] {
    c::require(graph, "graph");
    c::require(value, "value");
    const std::string wanted = c::requireText(nodeParam, "nodeParam");
    std::vector<std::string> names;
    for (const graph::Graph::Entry& entry : graph->state->graph.nodes()) {
      for (const params::Param& param : entry.node->params().all()) {
        names.push_back(entry.name + "." + param.name);
        if (names.back() != wanted) continue;
        graph->text = param.get();
        *value = graph->text.c_str();
        return;
      }
    }
    const std::string near = params::nearestName(wanted, names);
    throw Error(ErrorCode::BadInput, wanted + ": the graph has no such parameter" + (near.empty() ? "" : "; did you mean " + near + "?"));
  });
}

RadivoxResult radivoxApplyPreset(RadivoxGraph* graph, const char* json, const char* name) {
  return guarded(
      [&] { c::require(graph, "graph").state->graph.applyPreset(c::requireText(json, "json"), name != nullptr ? name : "preset"); });
}

uint32_t radivoxParameterCount(const RadivoxGraph* graph) {
  if (graph == nullptr) return 0;
  size_t count = 0;
  for (const graph::Graph::Entry& entry : graph->state->graph.nodes()) count += entry.node->params().all().size();
  return static_cast<uint32_t>(count);
}

RadivoxResult radivoxDescribeParameter(RadivoxGraph* graph, uint32_t index, RadivoxParameter* parameter) {
  return guarded([&] {
    c::require(graph, "graph");
    RadivoxParameter to{};
    const params::Param* param = findParam(graph->state->graph, index, &to.node);
    if (param == nullptr) {
      throw Error(ErrorCode::BadInput, "parameter " + std::to_string(index) + " of " + std::to_string(radivoxParameterCount(graph)));
    }
    graph->choices.clear();
    for (const std::string& choice : param->choices) graph->choices += (graph->choices.empty() ? "" : ",") + choice;
    switch (param->type) {
      case params::Type::Bool:
        to.type = RADIVOX_PARAMETER_BOOL;
        break;
      case params::Type::UInt:
        to.type = RADIVOX_PARAMETER_UINT;
        break;
      case params::Type::Float:
        to.type = RADIVOX_PARAMETER_FLOAT;
        break;
      case params::Type::Choice:
        to.type = RADIVOX_PARAMETER_CHOICE;
        break;
      case params::Type::Text:
        to.type = RADIVOX_PARAMETER_TEXT;
        break;
    }
    to.name = param->name.c_str();
    to.help = param->help.c_str();
    to.defaultValue = param->defaultValue.c_str();
    to.choices = graph->choices.c_str();
    to.minimum = param->range.min;
    to.maximum = param->range.max;
    to.replans = param->invalidates == params::Invalidates::Plan ? VK_TRUE : VK_FALSE;
    c::giveStruct(parameter, to, "parameter");
  });
}
