#include "tests/vdb/vdb_run.h"

#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>
#include <nanovdb/util/NanoToOpenVDB.h>

#include <fstream>
#include <iterator>

#include "engine/plugin/registry.h"
#include "modules/modules.h"
#include "modules/vdb/wiring.h"

namespace radivox::test {

VdbRun::VdbRun(gpu::Device& device, scene::Scene scene_, const VdbRunOptions& options) : scene(std::move(scene_)), device_(device) {
  plugin::Registry registry;
  registerModules(registry);
  std::ifstream file(RADIVOX_SOURCE_DIR "/samples/graphs/clustered_voxel.json");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  graph = graph::Graph::fromJson(text, "clustered_voxel.json", registry);
  sink_ = static_cast<const vdb::Write*>(&graph.add("dump", registry.make("vdb.write")));
  graph.set("dump.file", options.file);
  graph.set("dump.grids", options.grids);
  graph.set("dump.scene", "a scene");
  graph.set("dump.up", options.up);
  graph.set("voxelize.resolution", options.resolution);
  graph.set("visibility.rays", options.rays);
  if (options.allFaces) graph.set("gather.lazy", "off");
  const std::vector<vdb::GridName> grids = vdb::parseGrids(options.grids);
  if (!vdb::connectSink(graph, "dump", grids, registry).empty()) throw Error(ErrorCode::BadInput, "the graph lacks nodes");
  vdb::leaveOutRays(graph, grids);
  graph.clearOutputs();
  traits = scene::traitsFor(scene, {});
  gpuScene = std::make_unique<scene::GpuScene>(device, scene);
  gpuScene->setCamera(scene.cameras.at(0), options.width, options.height);
  const scene::Request request{.width = options.width, .height = options.height, .bounces = options.bounces, .aovs = {"color", "error"}};
  graph::Plan plan = graph::compile(graph, {traits, request, device.capabilities(), gpuScene->imports(), gpuScene->counts()});
  executor = std::make_unique<graph::Executor>(device, graph, std::move(plan), traits, request, gpuScene->counts());
  gpuScene->importInto(*executor);
  executor->run();
}

bool VdbRun::ran(const std::string& node) const {
  for (const graph::NodeStats& stats : executor->stats().nodes) {
    if (stats.name == node) return stats.runCount > 0;
  }
  return false;
}

std::vector<openvdb::GridBase::Ptr> readGrids(const std::string& file) {
  openvdb::initialize();
  std::vector<openvdb::GridBase::Ptr> grids;
  if (std::filesystem::path(file).extension() == ".nvdb") {
    for (const auto& handle : nanovdb::io::readGrids(file)) {
      if (const auto* floats = handle.grid<float>()) {
        grids.push_back(nanovdb::nanoToOpenVDB(*floats));
      } else if (const auto* integers = handle.grid<int32_t>()) {
        grids.push_back(nanovdb::nanoToOpenVDB(*integers));
      } else {
        grids.push_back(nanovdb::nanoToOpenVDB(*handle.grid<nanovdb::Vec3f>()));
      }
    }
    return grids;
  }
  openvdb::io::File vdb(file);
  vdb.open();
  const openvdb::GridPtrVecPtr all = vdb.getGrids();
  grids.assign(all->begin(), all->end());
  return grids;
}

openvdb::GridBase::Ptr findGrid(const std::vector<openvdb::GridBase::Ptr>& grids, const std::string& name) {
  for (const auto& grid : grids) {
    if (grid->getName() == name) return grid;
  }
  return nullptr;
}

}  // namespace radivox::test
