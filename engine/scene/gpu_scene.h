// The scene in device buffers: what the graph imports as scene.* and view.*. Only what the traits need is uploaded.
#pragma once

#include "engine/gpu/resources.h"
#include "engine/graph/executor.h"
#include "engine/scene/scene.h"

namespace radivox::scene {

struct LightOptions {
  uint32_t shadowResolution = 2048;       ///< texels a side of a directional or spot map
  uint32_t pointShadowResolution = 1024;  ///< a side of a cube face
  uint32_t emitterSamples = 32;           ///< points on emissive triangles, by power; 0: emitters light through voxel rays only
  uint32_t emitterShadowResolution = 256;
  /// What all shadow maps may take together (8 bytes a texel: depth and triangle). Past it resolutions are halved, largest class first,
  /// then emitter samples; if that is not enough, setUpLights throws OutOfMemory saying how many lights fit.
  uint64_t maxShadowBytes = 512ull << 20;
  uint32_t maxShadowSide = 4096;  ///< GpuScene lowers these two to the device's limits
  uint32_t maxShadowLayers = 256;
  /// Lights neither move nor change: views that no face is in get no texels, and lights whose range ends before the nearest face are none.
  bool fixed = false;
  uint32_t kept = 0;  ///< Traits::kept
};

/// Imports (names as in the plan):
///   scene.vertices  shared::Vertex      scene.indices u32 × 3       scene.triangle_materials u32
///   scene.materials shared::Material    scene.textures shared::Texture (texels by device address)
///   scene.info      shared::SceneInfo   scene.lights shared::Light  scene.shadow_views shared::ShadowView
///   scene.emissive_triangles shared::EmissiveTriangle               view.camera shared::Camera
///   scene.sky       vec3: bins, cells and texels of the sky's image (shaders/shared/sky.h); empty without one
/// scene.shadow_views is host visible (MemoryKind::Upload): frame.shadow_map reads the tiles from it while it records.
class GpuScene {
 public:
  GpuScene(gpu::Device& device, const Scene& scene, const LightOptions& options = {});

  // The setters need a device that is done with earlier frames; call importInto again after them.
  /// Lights and sky of `scene`: new versions of scene.info, .lights, .shadow_views; of scene.sky where it is another. Geometry keeps its version. Counts of lights and
  /// shadow layers may change, and with them a plan's shapes.
  void setLights(const Scene& scene);
  /// Vertices of `scene`, which has as many vertices and triangles as the one before, in the same order, and its lights. Where the bounds or another
  /// trait change (Scene::traits), the plan does not fit any more: compile again. Throws BadInput for other counts.
  void setGeometry(const Scene& scene);
  /// A new version of the geometry, which is the same: everything that depends on it runs again. For measuring what that costs.
  void touchGeometry() {
    ++geometryVersion_;
    ++vertexVersion_;
  }
  void setCamera(const CameraDescription& camera, uint32_t width, uint32_t height);
  void importInto(graph::Executor& executor) const;

  std::vector<graph::Import> imports() const;
  /// triangles, vertices, materials, lights, shadow_views, shadow_resolution (side of a layer), shadow_layers, emitter_samples,
  /// emissive_triangles, sky_texels (of scene.sky), width, height. The shadow image is shadow_resolution² × shadow_layers.
  graph::Counts counts() const;
  /// What had to be lowered to fit (LightSetup::notes), one line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void uploadTextures(const Scene& scene);
  void uploadSky(const Scene& scene);
  gpu::Device& device_;
  LightOptions options_;
  gpu::Buffer vertices_, indices_, triangleMaterials_, materials_, textureTable_, info_, lights_, shadowViews_, emissive_, camera_;
  std::vector<gpu::Buffer> texels_;
  gpu::Buffer sky_;
  std::shared_ptr<const Sky> uploadedSky_;
  uint64_t geometryVersion_ = 1, vertexVersion_ = 1, lightVersion_ = 1, cameraVersion_ = 1, skyVersion_ = 1;
  graph::Counts counts_;
  std::vector<std::string> notes_;
};

/// The same lights and shadow views on the host, without a device (used by GpuScene and by tests).
struct LightSetup {
  std::vector<shared::Light> lights;
  std::vector<shared::ShadowView> views;
  std::vector<shared::EmissiveTriangle> emissive;
  uint32_t shadowResolution = 1;                        ///< texels a side of every layer; views are tiles of layers
  uint32_t shadowLayers = 1;                            ///< at least 1, so that an image can always be made
  uint32_t emitterSampleCount = 0;                      ///< 0 with emissive triangles: emitters light through rays
  uint32_t darkViewCount = 0;                           ///< views without texels, since no face is in them
  uint32_t wholeShadowSide = 1, wholeShadowLayers = 1;  ///< with texels for those, too
  std::vector<std::string> notes;                       ///< what had to be lowered to fit, one line each
};
/// imports() and counts() of a GpuScene with a camera of this size, without a device: for printing plans.
struct SceneShapes {
  std::vector<graph::Import> imports;
  graph::Counts counts;
};
SceneShapes describeShapes(const Scene& scene, const LightOptions& options, uint32_t width, uint32_t height);

/// Scene::traits() with emittersByRays, what no light reaches, and what is kept, as these options have it.
Traits traitsFor(const Scene& scene, const LightOptions& options);
LightSetup setUpLights(const Scene& scene, const LightOptions& options);

}  // namespace radivox::scene
