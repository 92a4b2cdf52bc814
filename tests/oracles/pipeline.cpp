#include "tests/oracles/pipeline.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "modules/modules.h"

namespace radivox::oracles {

namespace {

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorCode::BadInput, "cannot read " + path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

Pipeline::Pipeline(gpu::Device& device, scene::Scene scene_, const PipelineOptions& options) : scene(std::move(scene_)), device_(device) {
  plugin::Registry registry;
  registerModules(registry);
  const std::string path = std::string(RADIVOX_SOURCE_DIR) + "/samples/graphs/" + options.graph + ".json";
  graph = std::make_unique<graph::Graph>(graph::Graph::fromJson(readFile(path), path, registry));
  for (const auto& [name, value] : options.settings) graph->set(name, value);
  for (const std::string& to : options.disconnected) graph->disconnect(to);
  graph->clearOutputs();
  for (const std::string& output : options.outputs) graph->output(output);

  scene::LightOptions lights = options.lights;
  lights.kept = options.kept;
  traits_ = scene::traitsFor(scene, lights);
  request_.width = options.width;
  request_.height = options.height;
  request_.bounces = options.bounces;
  request_.aovs = options.aovs;
  gpuScene = std::make_unique<scene::GpuScene>(device, scene, lights);
  gpuScene->setCamera(scene.cameras.front(), options.width, options.height);
  graph::Plan plan = graph::compile(*graph, {traits_, request_, device.capabilities(), gpuScene->imports(), gpuScene->counts()});
  executor = std::make_unique<graph::Executor>(device, *graph, std::move(plan), traits_, request_, gpuScene->counts());
  gpuScene->importInto(*executor);
}

void Pipeline::run() { executor->run(); }

void Pipeline::setCamera(const scene::CameraDescription& camera) {
  gpuScene->setCamera(camera, request_.width, request_.height);
  gpuScene->importInto(*executor);
}

void Pipeline::setLights(const scene::Scene& lit) {
  gpuScene->setLights(lit);
  gpuScene->importInto(*executor);
}

void Pipeline::setGeometry(const scene::Scene& moved) {
  gpuScene->setGeometry(moved);
  gpuScene->importInto(*executor);
}

image::Image Pipeline::picture4(const std::string& nodePort) {
  gpu::Image* from = executor->findImage(nodePort);
  if (from == nullptr) throw Error(ErrorCode::BadInput, "no image " + nodePort);
  const auto raw = gpu::download(device_, *from);
  image::Image out;
  out.width = from->info().width;
  out.height = from->info().height;
  out.channels = 4;
  out.data.resize(size_t{out.width} * out.height * 4);
  std::memcpy(out.data.data(), raw.data(), out.data.size() * sizeof(float));
  return out;
}

image::Image Pipeline::picture(const std::string& nodePort) {
  const image::Image rgba = picture4(nodePort);
  image::Image out;
  out.width = rgba.width;
  out.height = rgba.height;
  out.channels = 3;
  for (size_t i = 0; i < rgba.data.size(); ++i)
    if (i % 4 != 3) out.data.push_back(rgba.data[i]);
  return out;
}

double Pipeline::figure(const std::string& node, const std::string& name) const {
  for (const graph::NodeStats& stats : executor->stats().nodes)
    if (stats.name == node && stats.figures.contains(name)) return stats.figures.at(name);
  throw Error(ErrorCode::BadInput, "no figure " + node + "." + name);
}

uint32_t Pipeline::runCount(const std::string& node) const {
  for (const graph::NodeStats& stats : executor->stats().nodes)
    if (stats.name == node) return stats.runCount;
  throw Error(ErrorCode::BadInput, "no node " + node);
}

std::string sharedFolder() {
  const char* fromEnvironment = std::getenv("RADIVOX_SHARED");
  const std::string folder = fromEnvironment != nullptr ? fromEnvironment : std::string(RADIVOX_SOURCE_DIR) + "/../shared";
  return std::filesystem::exists(folder + "/scenes") ? folder : std::string();
}

}  // namespace radivox::oracles
