// The scene in device buffers: what the graph imports as scene.* and view.*. Only what the traits need is uploaded.
#pragma once

#include "engine/gpu/resources.h"
#include "engine/graph/executor.h"
#include "engine/scene/scene.h"

namespace radivox::scene {

struct LightOptions {
  uint32_t shadowResolution = 2048;        ///< texels a side of a directional or spot map
  uint32_t pointShadowResolution = 1024;   ///< a side of a cube face
  uint32_t emitterSamples = 32;            ///< points on emissive triangles, by power; 0: emitters light through voxel rays only
  uint32_t emitterShadowResolution = 256;
};

/// Imports (names as in the plan):
///   scene.vertices  shared::Vertex      scene.indices u32 × 3       scene.triangle_materials u32
///   scene.materials shared::Material    scene.textures shared::Texture (texels by device address)
///   scene.info      shared::SceneInfo   scene.lights shared::Light  scene.shadow_views shared::ShadowView
///   scene.emissive_triangles shared::EmissiveTriangle               view.camera shared::Camera
class GpuScene {
 public:
  GpuScene(gpu::Device& device, const Scene& scene, const LightOptions& options = {});

  /// New versions of scene.info / scene.lights / scene.shadow_views; geometry keeps its version.
  void setLights(const Scene& scene);
  void setCamera(const CameraDescription& camera, uint32_t width, uint32_t height);
  void importInto(graph::Executor& executor) const;

  std::vector<graph::Import> imports() const;
  graph::Counts counts() const;  ///< triangles, vertices, lights, shadow_views, shadow_resolution, emissive_triangles, width, height

 private:
  gpu::Device& device_;
  LightOptions options_;
  gpu::Buffer vertices_, indices_, triangleMaterials_, materials_, textureTable_, info_, lights_, shadowViews_, emissive_, camera_;
  std::vector<gpu::Buffer> texels_;
  uint64_t geometryVersion_ = 1, lightVersion_ = 1, cameraVersion_ = 1;
  graph::Counts counts_;
};

/// The same lights and shadow views on the host, without a device (used by GpuScene and by tests).
struct LightSetup {
  std::vector<shared::Light> lights;
  std::vector<shared::ShadowView> views;
  std::vector<shared::EmissiveTriangle> emissive;
  uint32_t shadowResolution = 1;  ///< largest in use; layers all have this size
};
LightSetup setUpLights(const Scene& scene, const LightOptions& options);

}  // namespace radivox::scene
