// Graphs and presets as text. Every error of a file comes in one message, each with its place: "graphs/x.json: nodes.voxelize.type: …".
#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/graph/graph.h"

namespace radivox::graph {
namespace {

using Json = nlohmann::ordered_json;

/// Errors of one file, thrown together.
class Errors {
 public:
  explicit Errors(std::string source) : source_(std::move(source)) {}
  void add(const std::string& place, const std::string& what) { text_ += (text_.empty() ? "" : "; ") + place + ": " + what; }
  void throwIfAny() const {
    if (!text_.empty()) throw Error(ErrorCode::BadInput, source_ + ": " + text_);
  }

 private:
  std::string source_;
  std::string text_;
};

/// nlohmann keeps the last of two equal keys; a file that says something twice is a mistake.
Json parse(std::string_view text, const std::string& source) {
  std::vector<std::vector<std::string>> keys;
  std::string repeated;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& name = parsed.get_ref<const std::string&>();
      if (std::find(keys.back().begin(), keys.back().end(), name) != keys.back().end()) repeated = name;
      keys.back().push_back(name);
    }
    return true;
  };
  try {
    Json json = Json::parse(text, watch);
    if (!repeated.empty()) throw Error(ErrorCode::BadInput, source + ": the key " + repeated + " is there twice; remove one");
    return json;
  } catch (const Json::exception& error) {  // parse errors, and numbers that no type holds
    // "[json.exception.parse_error.101] parse error at line 3, column 5: …"
    std::string what = error.what();
    const size_t start = what.find("] ");
    if (start != std::string::npos) what = what.substr(start + 2);
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw Error(ErrorCode::BadInput, source + ": " + what);
  }
}

void refuseUnknownKeys(const Json& object, const std::string& place, const std::vector<std::string>& known, Errors& errors) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string text = "unknown key";
    const std::string near = params::nearestName(key, known);
    if (!near.empty()) {
      text += "; did you mean " + near + "?";
    } else {
      for (size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "; it may hold " : ", ") + known[i];
    }
    errors.add(place.empty() ? key : place + "." + key, text);
  }
}

/// A parameter's value as the text that Table::set parses; empty optional with an error for lists and objects.
std::string valueText(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

bool isScalar(const Json& value) { return value.is_string() || value.is_boolean() || value.is_number(); }

/// Runs `action`; an Error becomes one of `errors`.
template <class Action>
void collect(Errors& errors, const std::string& place, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    errors.add(place, error.what());
  }
}

void readNodes(const Json& nodes, Graph& graph, const plugin::Registry& registry, Errors& errors) {
  if (!nodes.is_object()) {
    errors.add("nodes", "not an object; write {\"name\": {\"type\": \"…\"}, …}");
    return;
  }
  for (const auto& [name, description] : nodes.items()) {
    const std::string place = "nodes." + name;
    if (!description.is_object() || !description.contains("type") || !description["type"].is_string()) {
      errors.add(place, "has no type; write {\"type\": \"module.node\"}");
      continue;
    }
    refuseUnknownKeys(description, place, {"type", "params"}, errors);
    collect(errors, place + ".type", [&, &nodeName = name, &node = description] {
      std::unique_ptr<Node> made = registry.make(node["type"].get<std::string>());
      graph.add(nodeName, std::move(made));
    });
    if (!description.contains("params") || graph.find(name) == nullptr) continue;
    const Json& params = description["params"];
    if (!params.is_object()) {
      errors.add(place + ".params", "not an object; write {\"name\": value, …}");
      continue;
    }
    for (const auto& [param, value] : params.items()) {
      if (!isScalar(value)) {
        errors.add(place + ".params." + param, "not a value; write a number, true, false or a name");
        continue;
      }
      collect(errors, place + ".params",
              [&, &nodeName = name, &paramName = param, &v = value] { graph.set(nodeName + "." + paramName, valueText(v)); });
    }
  }
}

void readEdges(const Json& edges, Graph& graph, Errors& errors) {
  if (!edges.is_array()) {
    errors.add("edges", "not a list; write [[\"node.port\", \"node.port\"], …]");
    return;
  }
  for (size_t i = 0; i < edges.size(); ++i) {
    const std::string place = "edges[" + std::to_string(i) + "]";
    const Json& edge = edges[i];
    if (!edge.is_array() || edge.size() != 2 || !edge[0].is_string() || !edge[1].is_string()) {
      errors.add(place, "not an edge; write [\"node.port\", \"node.port\"]");
      continue;
    }
    collect(errors, place, [&] { graph.connect(edge[0].get<std::string>(), edge[1].get<std::string>()); });
  }
}

void readOutputs(const Json& outputs, Graph& graph, Errors& errors) {
  if (!outputs.is_array()) {
    errors.add("outputs", "not a list; write [\"node.port\", …]");
    return;
  }
  for (size_t i = 0; i < outputs.size(); ++i) {
    const std::string place = "outputs[" + std::to_string(i) + "]";
    if (!outputs[i].is_string()) {
      errors.add(place, "not a name; write \"node.port\"");
      continue;
    }
    collect(errors, place, [&] { graph.output(outputs[i].get<std::string>()); });
  }
}

void readAovs(const Json& aovs, Graph& graph, Errors& errors) {
  if (!aovs.is_object()) {
    errors.add("aovs", "not an object; write {\"color\": \"node.port\", …}");
    return;
  }
  for (const auto& [name, endpoint] : aovs.items()) {
    if (!endpoint.is_string()) {
      errors.add("aovs." + name, "not a name; write \"node.port\"");
      continue;
    }
    const std::string text = endpoint.get<std::string>();
    const std::string node = text.substr(0, text.find('.'));
    if (graph.find(node) == nullptr || node.size() == text.size()) {
      std::vector<std::string> names;
      for (const Graph::Entry& entry : graph.nodes()) names.push_back(entry.name);
      const std::string near = params::nearestName(node, names);
      errors.add("aovs." + name, text + " names no node and port" + (near.empty() ? "" : "; did you mean node " + near + "?"));
      continue;
    }
    graph.setAov(name, text);
  }
}

Json paramsToJson(const params::Table& table) {
  Json json = Json::object();
  for (const params::Param& param : table.all()) {
    const std::string value = param.get();
    if (value == param.defaultValue) continue;
    const bool isText = param.type == params::Type::Choice || param.type == params::Type::Text;
    json[param.name] = isText ? Json(value) : Json::parse(value);
  }
  return json;
}

}  // namespace

Graph Graph::fromJson(std::string_view text, const std::string& source, const plugin::Registry& registry) {
  const Json json = parse(text, source);
  Errors errors(source);
  Graph graph;
  if (!json.is_object()) {
    errors.add("top level", "not an object; write {\"nodes\": {…}, \"edges\": […], \"outputs\": […]}");
  } else {
    refuseUnknownKeys(json, "", {"help", "nodes", "edges", "outputs", "aovs"}, errors);
    if (json.contains("nodes")) {
      readNodes(json["nodes"], graph, registry, errors);
    } else {
      errors.add("nodes", "missing; a graph needs {\"nodes\": {…}}");
    }
    if (json.contains("edges")) readEdges(json["edges"], graph, errors);
    if (json.contains("outputs")) readOutputs(json["outputs"], graph, errors);
    if (json.contains("aovs")) readAovs(json["aovs"], graph, errors);
    if (json.contains("help")) {
      if (json["help"].is_string()) {
        graph.help_ = json["help"].get<std::string>();
      } else {
        errors.add("help", "not a text");
      }
    }
  }
  errors.throwIfAny();
  return graph;
}

std::string Graph::toJson() const {
  Json json;
  if (!help_.empty()) json["help"] = help_;
  json["nodes"] = Json::object();
  for (const Entry& entry : nodes_) {
    Json& node = json["nodes"][entry.name];
    node["type"] = std::string(entry.node->type());
    Json params = paramsToJson(entry.node->params());
    if (!params.empty()) node["params"] = std::move(params);
  }
  json["edges"] = Json::array();
  for (const Edge& edge : edges_) json["edges"].push_back({edge.from.print(), edge.to.print()});
  json["outputs"] = Json::array();
  for (const Endpoint& endpoint : outputs_) json["outputs"].push_back(endpoint.print());
  if (!aovs_.empty()) json["aovs"] = aovs_;
  return json.dump(2) + "\n";
}

void Graph::applyPreset(std::string_view text, const std::string& source) {
  const Json json = parse(text, source);
  Errors errors(source);
  if (!json.is_object()) {
    errors.add("top level", "not an object; write {\"name\": \"…\", \"set\": {\"node.param\": value, …}}");
    errors.throwIfAny();
  }
  refuseUnknownKeys(json, "", {"name", "help", "graph", "request", "set"}, errors);
  for (const char* key : {"name", "help"}) {
    if (json.contains(key) && !json[key].is_string()) errors.add(key, "not a text");
  }
  const Json settings = json.contains("set") ? json["set"] : Json::object();
  if (!settings.is_object()) {
    errors.add("set", "not an object; write {\"node.param\": value, …}");
    errors.throwIfAny();
  }
  // All or nothing: a preset with an error leaves the graph as it was.
  std::vector<std::pair<std::string, std::string>> before;
  for (const Entry& entry : nodes_) {
    for (const params::Param& param : entry.node->params().all()) before.emplace_back(entry.name + "." + param.name, param.get());
  }
  for (const auto& [name, value] : settings.items()) {
    if (!isScalar(value)) {
      errors.add("set." + name, "not a value; write a number, true, false or a name");
      continue;
    }
    collect(errors, "set", [&, &nodeParam = name, &v = value] { set(nodeParam, valueText(v)); });
  }
  try {
    errors.throwIfAny();
  } catch (const Error&) {
    for (const auto& [name, value] : before) set(name, value);
    throw;
  }
}

}  // namespace radivox::graph
