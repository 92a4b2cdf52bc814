// radivox vdb: voxels, clusters and their light as grids of a file; what such a file holds; how two of them differ.
#include <filesystem>
#include <iostream>

#include "engine/error.h"
#include "samples/cli/assets.h"
#include "samples/cli/options.h"

#ifdef RADIVOX_WITH_VDB

#include <algorithm>
#include <cstdio>

#include "engine/graph/plan.h"
#include "modules/vdb/inspect.h"
#include "modules/vdb/wiring.h"
#include "modules/vdb/write_node.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/progress.h"

namespace radivox::cli {

namespace {

constexpr const char* kSink = "vdb_file";  // the node's name in the graph

void requireChoice(const std::string& option, const std::string& value, const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) failUnknown(option, value, choices);
}

/// A file's name without its folder: the same scene gives the same bytes wherever it lies.
std::string nameOf(const std::string& scene) {
  return scene.rfind("builtin:", 0) == 0 ? scene : std::filesystem::path(scene).filename().string();
}

std::string printMiB(uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / 1048576.0);
  return text;
}

/// "NAME: why" lines, those of one reason together.
void warnLeftOut(const std::vector<std::string>& leftOut) {
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const std::string& line : leftOut) {
    const std::string name = line.substr(0, line.find(": ")), why = line.substr(line.find(": ") + 2);
    const auto known = std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == why; });
    if (known == reasons.end()) {
      reasons.emplace_back(why, name);
    } else {
      known->second += ", " + name;
    }
  }
  for (const auto& [why, names] : reasons) std::cerr << "radivox: warning: left out " << names << ": " << why << "\n";
}

/// The graph of the job with the sink at its end and nothing else that would be kept.
void addSink(const Options& options, const VdbOptions& vdb, const std::vector<vdb::GridName>& grids, Job& job) {
  if (job.graph.find(kSink) != nullptr) {
    throw Error(ErrorCode::BadInput, "graph " + job.graphName + " has a node named " + std::string(kSink) + "; rename it");
  }
  job.graph.add(kSink, job.registry.make("vdb.write"));
  const auto set = [&](const char* param, const std::string& value) { job.graph.set(std::string(kSink) + "." + param, value); };
  set("file", options.outputs.front());
  if (!vdb.grids.empty()) set("grids", vdb.grids);
  set("scene", nameOf(options.scene));
  set("up", vdb.up);
  const std::vector<std::string> missing = vdb::connectSink(job.graph, kSink, grids, job.registry);
  for (const char* port : {"clustered_voxel.voxelize", "clustered_voxel.index"}) {
    for (const std::string& line : missing) {
      if (line.substr(line.find(": ") + 2) != port) continue;
      throw Error(ErrorCode::BadInput, "graph " + job.graphName + " makes no voxels (it has no " + port + "); use --graph " + kFaceGraph);
    }
  }
  for (const vdb::GridName& grid : grids) {
    for (const std::string& line : missing) {
      if (!grid.named || line.rfind(grid.print() + ": ", 0) != 0) continue;
      throw Error(ErrorCode::BadInput, "grid '" + grid.print() + "': graph " + job.graphName + " has no " +
                                           line.substr(line.find(": ") + 2) + "; leave the grid out, or use --graph " + kFaceGraph);
    }
  }
  vdb::leaveOutRays(job.graph, grids);
  job.graph.clearOutputs();
  if (vdb.faces == "view") return;
  for (const graph::Graph::Entry& entry : job.graph.nodes()) {
    if (entry.node->type() == "clustered_voxel.gather") job.graph.set(entry.name + ".lazy", "off");
  }
}

void checkOutput(const Options& options) {
  if (options.outputs.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a .vdb or .nvdb file to write");
  if (options.outputs.size() > 1) throw Error(ErrorCode::BadInput, "--out is there twice; give one .vdb or .nvdb file");
  vdb::checkFileName(options.outputs.front());
}

void printSummary(const std::string& file, const vdb::DumpSummary& summary, const graph::FrameStats& stats) {
  warnLeftOut(summary.leftOut);
  char edge[32];
  std::snprintf(edge, sizeof edge, "%.4g", static_cast<double>(summary.voxelEdge));
  std::cout << file << ": " << summary.grids.size() << (summary.grids.size() == 1 ? " grid" : " grids") << " of " << summary.voxelCount
            << " voxels of " << edge << " m (N = " << summary.resolution << "), " << printMiB(summary.fileBytes) << "\n"
            << "memory at most: " << printMiB(stats.memory.peak) << " of the device, and " << printMiB(summary.memoryBytes)
            << " of the host to write\n";
}

int writeVdb(Options options, const VdbOptions& vdb) {
  checkOutput(options);
  const std::vector<vdb::GridName> grids = vdb::parseGrids(vdb.grids.empty() ? std::string(vdb::kDefaultGrids) : vdb.grids);
  requireChoice("--faces", vdb.faces, {"all", "view"});
  requireChoice("--up", vdb.up, {"y", "z"});
  parseSize(options.size);
  // All faces are gathered whatever is on screen: the smallest picture will do.
  if (vdb.faces == "all") options.size = "16x16";
  std::unique_ptr<gpu::Device> device;  // outlives the job, whose nodes hold pipelines
  Job job;
  prepareJob(options, false, job, kFaceGraph);  // it has every grid
  addSink(options, vdb, grids, job);
  if ((vdb::needsOf(grids) & vdb::NeedError) != 0) job.request.aovs.insert("error");
  stopIfInterrupted();

  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  const scene::CameraDescription& camera = scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  for (const std::string& warning : scene.warnings) std::cerr << "radivox: warning: " << warning << "\n";
  stopIfInterrupted();
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = parseDevice(options.device);
  deviceOptions.pipelineCacheFile = pipelineCacheFile();
  device = gpu::Device::create(deviceOptions);
  scene::GpuScene gpuScene(*device, scene, job.lights);
  gpuScene.setCamera(camera, job.request.width, job.request.height);
  for (const std::string& note : gpuScene.notes()) std::cerr << "radivox: warning: " << note << "\n";
  const scene::Traits traits = scene::traitsFor(scene, job.lights);
  graph::Plan plan = graph::compile(job.graph, {traits, job.request, device->capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(*device, job.graph, std::move(plan), traits, job.request, gpuScene.counts());
  gpuScene.importInto(executor);
  stopIfInterrupted();
  {
    ProgressBar bar;
    executor.run([&bar](std::string_view node, double fraction) { bar.show(node, fraction); }, isInterrupted);
  }
  stopIfInterrupted();
  printSummary(options.outputs.front(), static_cast<const vdb::Write*>(job.graph.find(kSink))->summary(), executor.stats());
  return 0;
}

}  // namespace

int runVdb(const Options& options, const VdbOptions& vdb) {
  if (vdb.grids == "help") {
    std::cout << vdb::printCatalogue();
    return 0;
  }
  if (vdb.print.empty() && vdb.diff.empty()) return writeVdb(options, vdb);
  const char* what = vdb.print.empty() ? "--diff" : "--print";
  if (!options.scene.empty() || !options.outputs.empty() || (!vdb.print.empty() && !vdb.diff.empty())) {
    throw Error(ErrorCode::BadInput, std::string(what) + " reads files and goes alone; leave out SCENE, --out and other such options");
  }
  std::string text;
  {
    ProgressBar bar;
    const vdb::Checkpoint checkpoint = [&](double fraction) {
      stopIfInterrupted();
      bar.show("reading", fraction);
    };
    text = vdb.print.empty() ? vdb::diffFiles(vdb.diff[0], vdb.diff[1], checkpoint).text : vdb::printFile(vdb.print, checkpoint);
  }
  std::cout << text;
  return 0;
}

}  // namespace radivox::cli

#else

#include "samples/cli/missing.h"

namespace radivox::cli {

int runVdb(const Options&, const VdbOptions&) { throw Error(ErrorCode::Unsupported, std::string("this build has no OpenVDB; ") + kGetVdb); }

}  // namespace radivox::cli

#endif
