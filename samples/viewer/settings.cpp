#include "samples/viewer/settings.h"

#include "engine/error.h"

namespace radivox::viewer {

Settings::Settings(const cli::Options& options) : modules_(options.modules) { load(options); }

void Settings::load(const cli::Options& options) {
  auto job = std::make_unique<cli::Job>();
  cli::prepareJob(options, true, *job, cli::kFaceGraph);  // faces stay lit while the camera walks, and the overlays show them
  job_ = std::move(job);
  // A file keeps its path, so that it can be found again.
  graph_ = options.graph.value_or(job_->graphName);
  preset_ = options.presets.empty() ? "" : options.presets.back();
}

std::vector<Settings::Group> Settings::groups() const {
  std::vector<Group> groups;
  for (const graph::Graph::Entry& entry : job_->graph.nodes()) {
    if (!entry.node->params().all().empty()) groups.push_back({entry.name, std::string(entry.node->type()), &entry.node->params()});
  }
  groups.push_back({"lights", "shadow maps and emitter samples", &job_->lightParams});
  return groups;
}

void Settings::set(const std::string& nodeParam, const std::string& value) {
  const size_t dot = nodeParam.find('.');
  if (nodeParam.substr(0, dot) == "lights" && dot != std::string::npos) {
    job_->lightParams.set("lights", nodeParam.substr(dot + 1), value);
  } else {
    job_->graph.set(nodeParam, value);
  }
}

std::vector<std::string> Settings::values() const {
  std::vector<std::string> values;
  for (const Group& group : groups()) {
    for (const params::Param& param : group.table->all()) values.push_back(group.node + "." + param.name + "=" + param.get());
  }
  return values;
}

void Settings::chooseGraph(const std::string& name) {
  cli::Options options;
  options.modules = modules_;
  options.graph = name;
  options.bounces = bounces();
  load(options);
}

void Settings::choosePreset(const std::string& name) {
  cli::Options options;
  options.modules = modules_;
  options.presets = {name};
  load(options);
}

void Settings::setBounces(const std::string& text) { job_->request.bounces = cli::parseBounces(text); }

std::string Settings::bounces() const {
  return job_->request.bounces == scene::kAllBounces ? "all" : std::to_string(job_->request.bounces);
}

std::vector<std::string> Settings::aovs() const {
  std::vector<std::string> names;
  for (const auto& [name, endpoint] : job_->graph.aovs()) {
    if (name != "color" && name != "display") names.push_back(name);
  }
  return names;
}

}  // namespace radivox::viewer
