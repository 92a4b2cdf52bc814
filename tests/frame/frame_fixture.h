// Small scenes made in code, and a run of the frame module's nodes on them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/image/image.h"
#include "engine/scene/gpu_scene.h"

namespace radivox::frame_test {

/// Builds a scene quad by quad. Corners counter-clockwise from the front.
class SceneBuilder {
 public:
  SceneBuilder();
  uint32_t addMaterial(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.f), uint32_t flags = 0);
  void addTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint32_t material = 0);
  void addQuad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, uint32_t material = 0);
  void addBox(const glm::vec3& low, const glm::vec3& high, uint32_t material = 0);  ///< outward
  void addSun(const glm::vec3& direction, const glm::vec3& irradiance);
  void addPoint(const glm::vec3& position, const glm::vec3& intensity, float range = 0.f);
  void addSpot(const glm::vec3& position, const glm::vec3& direction, const glm::vec3& intensity, float inner, float outer);
  void lookAt(const glm::vec3& from, const glm::vec3& to, float yfov = 0.8f);  ///< the first camera
  void lookParallel(const glm::vec3& from, const glm::vec3& to, float ymag);
  scene::Scene scene;
};

struct FrameOptions {
  uint32_t width = 64, height = 48;
  uint32_t bounces = 0;
  uint32_t voxels = 0;  ///< resolution of the grid whose triangles decide shadows; 0: maps alone. Needs `bounces`
  std::vector<std::pair<std::string, std::string>> settings;  ///< "direct.filter" = "0"
  std::vector<std::string> outputs{"composite.color"};
  scene::LightOptions lights;
};

/// gbuffer, shadow_map, direct, composite, tone_map, and the voxels' triangles where `voxels` asks for them, wired as the sample graphs wire them.
class FrameRun {
 public:
  FrameRun(gpu::Device& device, const scene::Scene& scene, const FrameOptions& options);
  bool has(const std::string& nodePort) const { return executor->findImage(nodePort) != nullptr; }
  std::vector<glm::vec4> pixels(const std::string& nodePort);
  std::vector<uint32_t> words(const std::string& nodePort, uint32_t layer = 0);
  std::vector<float> depths(const std::string& nodePort, uint32_t layer);
  image::Image picture(const std::string& nodePort);  ///< RGB
  double figure(const std::string& node, const std::string& name) const;
  std::string culledReason(const std::string& node) const;

  std::unique_ptr<graph::Graph> graph;
  std::unique_ptr<scene::GpuScene> gpuScene;
  std::unique_ptr<graph::Executor> executor;

 private:
  gpu::Device& device_;
};

/// By type name, from the linked-in modules.
std::unique_ptr<graph::Node> makeNode(const std::string& type);

/// Writes a PNG of the image, exposed to its 99th percentile, into $RADIVOX_TEST_IMAGES if that is set: for looking at.
void show(const image::Image& linear, const std::string& name);

}  // namespace radivox::frame_test
