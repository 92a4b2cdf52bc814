// Radivox inside a host: all the code that global illumination takes.
#pragma once

#include <string>

#include "engine/gpu/requirements.h"
#include "engine/graph/executor.h"
#include "engine/scene/gpu_scene.h"
#include "gbuffer.h"

class Gi {
 public:
  /// `module`: a library with the node sample.fog to put behind the picture; empty: none.
  Gi(const Host& host, HostGBuffer& gbuffer, const radivox::scene::Scene& scene, const DeviceWishes& enabled, const std::string& module);

  void moveCamera(const radivox::scene::CameraDescription& camera) { gpuScene_->setCamera(camera, width_, height_); }
  void moveLights(const radivox::scene::Scene& scene) { gpuScene_->setLights(scene); }

  /// The G-buffer has been drawn anew. True: lighting is recorded into `commands`, behind it; call finished() when the GPU is done. False:
  /// sizes or memory are missing; submit what you have, wait, and call runNow().
  bool record(VkCommandBuffer commands);
  void finished() { executor_->frameCompleted(); }
  void runNow() { executor_->run(); }
  VkImage picture();  ///< linear radiance, RGBA32F, in GENERAL

 private:
  void importFrame();
  uint32_t width_, height_;
  HostGBuffer& gbuffer_;
  radivox::scene::Traits traits_;
  radivox::scene::Request request_;
  // From the bottom up: what is below is destroyed first.
  std::unique_ptr<radivox::gpu::Device> device_;
  radivox::plugin::Registry registry_;
  radivox::graph::Graph graph_;
  std::unique_ptr<radivox::scene::GpuScene> gpuScene_;
  std::vector<radivox::gpu::Image> imports_;
  std::unique_ptr<radivox::graph::Executor> executor_;
  std::string output_ = "composite.color";
  uint64_t frame_ = 0;
};
