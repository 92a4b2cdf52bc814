#include "tests/clustered_voxel/voxel_run.h"

#include <stdexcept>

#include "modules/clustered_voxel/index/index.h"
#include "modules/clustered_voxel/voxelize/faces.h"
#include "modules/clustered_voxel/voxelize/surface.h"
#include "modules/clustered_voxel/voxelize/voxelize.h"

namespace radivox::oracle {

VoxelRun::VoxelRun(gpu::Device& device, const scene::Scene& scene, uint32_t resolution, const std::string& method, const Settings& settings)
    : device_(device), gpuScene_(device, scene), traits_(scene.traits()) {
  graph_.add("voxelize", std::make_unique<clustered_voxel::Voxelize>());
  graph_.add("index", std::make_unique<clustered_voxel::Index>());
  graph_.add("faces", std::make_unique<clustered_voxel::Faces>());
  graph_.add("surface", std::make_unique<clustered_voxel::Surface>());
  const auto feed = [&](const std::string& from, std::initializer_list<const char*> nodes) {
    for (const char* node : nodes) graph_.connect(from, std::string(node) + from.substr(from.find('.')));
  };
  feed("voxelize.grid", {"index", "faces", "surface"});
  feed("voxelize.occupancy", {"index", "faces", "surface"});
  feed("index.rank", {"faces", "surface"});
  feed("index.voxels", {"surface"});
  feed("faces.mask", {"surface"});
  feed("faces.first", {"surface"});
  for (const char* output : {"voxelize.grid", "voxelize.occupancy", "index.rank", "index.voxels", "index.distance", "faces.mask",
                             "faces.first", "surface.faces", "surface.emission"})
    graph_.output(output);
  graph_.set("voxelize.resolution", std::to_string(resolution));
  for (const char* node : {"voxelize", "faces", "surface"}) graph_.set(std::string(node) + ".method", method);
  for (const auto& [name, value] : settings) graph_.set(name, value);
  graph::Plan plan = graph::compile(graph_, {traits_, request_, device.capabilities(), gpuScene_.imports(), gpuScene_.counts()});
  executor_ = std::make_unique<graph::Executor>(device, graph_, std::move(plan), traits_, request_, gpuScene_.counts());
  gpuScene_.importInto(*executor_);
}

VoxelStructures VoxelRun::structures() {
  executor_->run();
  const size_t voxels = executor_->counts().at("voxels"), faces = executor_->counts().at("faces");
  VoxelStructures s;
  s.grid = download<shared::Grid>("voxelize.grid", 1).front();
  s.occupancy = download<glm::uvec2>("voxelize.occupancy", s.grid.brickCount);
  s.rank = download<uint32_t>("index.rank", s.grid.brickCount);
  s.voxels = download<uint32_t>("index.voxels", voxels);
  s.distance = download<uint32_t>("index.distance", (s.grid.brickCount + 3) / 4);
  s.mask = download<uint32_t>("faces.mask", voxels);
  s.first = download<uint32_t>("faces.first", voxels + 1);
  s.faces = download<shared::Face>("surface.faces", faces);
  s.emission = download<glm::vec3>("surface.emission", faces);
  return s;
}

double VoxelRun::figure(const std::string& node, const std::string& name) const {
  for (const graph::NodeStats& stats : executor_->stats().nodes)
    if (stats.name == node) return stats.figures.at(name);
  throw std::logic_error("no node " + node);
}

double VoxelRun::gpuMs(const std::string& node) const {
  for (const graph::NodeStats& stats : executor_->stats().nodes)
    if (stats.name == node) return stats.gpuMs;
  throw std::logic_error("no node " + node);
}

}  // namespace radivox::oracle
