// voxelize → index → faces → surface over a scene on the device, and what they wrote as the CPU structures: for tests.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/scene/gpu_scene.h"
#include "tests/oracles/voxel_structures.h"

namespace radivox::oracle {

class VoxelRun {
 public:
  using Settings = std::vector<std::pair<std::string, std::string>>;
  /// `method` goes to all three nodes that loop over triangles.
  VoxelRun(gpu::Device& device, const scene::Scene& scene, uint32_t resolution, const std::string& method = "compute",
           const Settings& settings = {});

  VoxelStructures structures();  ///< runs what is stale first; without voxelArea
  double figure(const std::string& node, const std::string& name) const;
  double gpuMs(const std::string& node) const;
  graph::Executor& executor() { return *executor_; }

 private:
  template <class T>
  std::vector<T> download(const std::string& nodePort, size_t count) {
    return gpu::downloadAs<T>(device_, *executor_->findBuffer(nodePort), count);
  }
  gpu::Device& device_;
  graph::Graph graph_;
  scene::GpuScene gpuScene_;
  scene::Traits traits_;
  scene::Request request_;
  std::unique_ptr<graph::Executor> executor_;
};

}  // namespace radivox::oracle
