// A whole render for tests: scene → graph → executor, with any buffer or image of it at hand afterwards.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/image/image.h"
#include "engine/scene/gpu_scene.h"

namespace radivox::oracles {

struct PipelineOptions {
  std::string graph = "clustered_voxel";                      ///< samples/graphs/NAME.json
  std::vector<std::pair<std::string, std::string>> settings;  ///< "voxelize.resolution" = "32"
  std::vector<std::string> disconnected;                      ///< edges into these are taken away
  std::vector<std::string> outputs{"composite.color"};        ///< what the graph keeps
  uint32_t width = 96, height = 64;
  uint32_t bounces = scene::kAllBounces;
  std::set<std::string> aovs{"color"};  ///< of the request: some nodes look at it
  scene::LightOptions lights;
  uint32_t kept = 0;  ///< of scene::Traits: what is computed though it is not needed
};

class Pipeline {
 public:
  Pipeline(gpu::Device& device, scene::Scene scene, const PipelineOptions& options);
  void run();
  void setCamera(const scene::CameraDescription& camera);
  void setLights(const scene::Scene& scene);
  void setGeometry(const scene::Scene& scene);

  template <class T>
  std::vector<T> buffer(const std::string& nodePort) {
    const gpu::Buffer* b = executor->findBuffer(nodePort);
    if (b == nullptr) throw Error(ErrorCode::BadInput, "no buffer " + nodePort);
    return gpu::downloadAs<T>(device_, *b, b->bytes() / sizeof(T));
  }
  /// The first `count` items.
  template <class T>
  std::vector<T> buffer(const std::string& nodePort, size_t count) {
    auto all = buffer<T>(nodePort);
    all.resize(count);
    return all;
  }
  image::Image picture(const std::string& nodePort);  ///< RGB of an RGBA32F image
  image::Image picture4(const std::string& nodePort);
  uint64_t count(const std::string& name) const { return executor->counts().at(name); }
  double figure(const std::string& node, const std::string& name) const;
  uint32_t runCount(const std::string& node) const;

  scene::Scene scene;
  std::unique_ptr<graph::Graph> graph;
  std::unique_ptr<scene::GpuScene> gpuScene;
  std::unique_ptr<graph::Executor> executor;

 private:
  gpu::Device& device_;
  scene::Traits traits_;
  scene::Request request_;
};

/// ../shared or $RADIVOX_SHARED; empty where it is not there.
std::string sharedFolder();

}  // namespace radivox::oracles
