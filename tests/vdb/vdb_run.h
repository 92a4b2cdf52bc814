// A clustered-voxel graph with vdb.write at its end, run once; its buffers and the file at hand.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/scene/gpu_scene.h"
#include "modules/vdb/write_node.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::test {

struct VdbRunOptions {
  std::string file;
  std::string grids = "all";
  std::string up = "y";
  std::string resolution = "20";
  std::string rays = "16";
  bool allFaces = true;
  uint32_t width = 16, height = 16;
  uint32_t bounces = scene::kAllBounces;
};

class VdbRun {
 public:
  VdbRun(gpu::Device& device, scene::Scene scene, const VdbRunOptions& options);

  template <class T>
  std::vector<T> buffer(const std::string& nodePort, size_t count) const {
    const gpu::Buffer* b = executor->findBuffer(nodePort);
    if (b == nullptr) throw Error(ErrorCode::BadInput, "no buffer " + nodePort);
    return gpu::downloadAs<T>(device_, *b, count);
  }
  size_t count(const std::string& name) const { return executor->counts().at(name); }
  bool ran(const std::string& node) const;
  const vdb::Write& sink() const { return *sink_; }

  scene::Scene scene;
  graph::Graph graph;
  scene::Traits traits;
  std::unique_ptr<scene::GpuScene> gpuScene;
  std::unique_ptr<graph::Executor> executor;

 private:
  gpu::Device& device_;
  const vdb::Write* sink_ = nullptr;
};

/// Every grid of a .vdb or .nvdb file, by OpenVDB's and NanoVDB's own readers.
std::vector<openvdb::GridBase::Ptr> readGrids(const std::string& file);
openvdb::GridBase::Ptr findGrid(const std::vector<openvdb::GridBase::Ptr>& grids, const std::string& name);

}  // namespace radivox::test
