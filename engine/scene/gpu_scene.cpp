// The scene's buffers on the device.
#include "engine/scene/gpu_scene.h"

#include <algorithm>

#include "engine/scene/sky.h"
#include "engine/scene/texture.h"
#include "shaders/shared/sky.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::scene {

namespace {

using graph::Extent;
using graph::Shape;

template <class T>
gpu::Buffer makeBuffer(gpu::Device& device, const std::string& name, const std::vector<T>& data) {
  gpu::Buffer buffer(device, name, data.size() * sizeof(T));
  if (!data.empty()) gpu::upload(device, buffer, data);
  return buffer;
}

/// In memory that the host can write: small, changed often, and read by nodes while they record.
template <class T>
gpu::Buffer makeHostBuffer(gpu::Device& device, const std::string& name, const std::vector<T>& data) {
  gpu::Buffer buffer(device, name, data.size() * sizeof(T), gpu::MemoryKind::Upload);
  if (!data.empty()) std::memcpy(buffer.mapped(), data.data(), data.size() * sizeof(T));
  return buffer;
}

/// Hosts make scenes too: what files are held to on import (METHODS section 0) holds for theirs, or light would bounce for ever.
std::vector<shared::Material> clampMaterials(const std::vector<shared::Material>& materials) {
  std::vector<shared::Material> clamped = materials;
  for (shared::Material& material : clamped) {
    // max first: what is not a number becomes 0.
    material.albedo = glm::min(glm::max(glm::vec3(0.f), material.albedo), glm::vec3(shared::kMostAlbedo));
    material.emission = glm::max(glm::vec3(0.f), material.emission);
  }
  return clamped;
}

/// Shaders see a buffer through one binding, whose range is limited.
void checkRange(const gpu::Device& device, const Scene& scene, const char* name, uint64_t bytes) {
  const uint64_t limit = device.capabilities().maxStorageBufferRange;
  if (bytes <= limit) return;
  const auto share = static_cast<double>(limit) / static_cast<double>(bytes);
  throw Error(ErrorCode::OutOfMemory, scene.name + ": its " + std::to_string(scene.triangleCount()) + " triangles need " +
                                          std::to_string(bytes) + " bytes of " + name + ", " + device.capabilities().deviceName +
                                          " binds at most " + std::to_string(limit) + "; about " +
                                          std::to_string(static_cast<uint64_t>(share * static_cast<double>(scene.triangleCount()))) +
                                          " triangles fit: simplify the scene or use another device");
}

/// Textures share buffers of about this size, so that hundreds of them are a few allocations.
constexpr uint64_t kTexelBufferBytes = 64ull << 20;

void countGeometry(const Scene& scene, graph::Counts& counts) {
  counts["triangles"] = scene.triangleCount();
  counts["vertices"] = scene.vertices.size();
  counts["materials"] = scene.materials.size();
  counts["textures"] = scene.textures.size();
}

void countSky(const Scene& scene, graph::Counts& counts) {
  counts["sky_texels"] = scene.sky ? shared::kSkyFirstTexel + scene.sky->texels.size() : 0;
}

void countLights(const LightSetup& setup, graph::Counts& counts) {
  counts["lights"] = setup.lights.size();
  counts["shadow_views"] = setup.views.size();
  counts["shadow_resolution"] = setup.shadowResolution;
  counts["shadow_layers"] = setup.shadowLayers;
  counts["emitter_samples"] = setup.emitterSampleCount;
  counts["emissive_triangles"] = setup.emissive.size();
}

std::vector<graph::Import> listImports() {
  return {
      {"scene.vertices", Shape::buffer(sizeof(shared::Vertex), Extent::of("vertices"))},
      {"scene.indices", Shape::buffer(sizeof(uint32_t), Extent::of("triangles") * 3)},
      {"scene.triangle_materials", Shape::buffer(sizeof(uint32_t), Extent::of("triangles"))},
      {"scene.materials", Shape::buffer(sizeof(shared::Material), Extent::of("materials"))},
      {"scene.textures", Shape::buffer(sizeof(shared::Texture), Extent::of("textures"))},
      {"scene.info", Shape::buffer(sizeof(shared::SceneInfo), 1)},
      {"scene.lights", Shape::buffer(sizeof(shared::Light), Extent::of("lights"))},
      {"scene.shadow_views", Shape::buffer(sizeof(shared::ShadowView), Extent::of("shadow_views"))},
      {"scene.emissive_triangles", Shape::buffer(sizeof(shared::EmissiveTriangle), Extent::of("emissive_triangles"))},
      {"scene.sky", Shape::buffer(sizeof(glm::vec3), Extent::of("sky_texels"))},
      {"view.camera", Shape::buffer(sizeof(shared::Camera), 1)},
  };
}

}  // namespace

SceneShapes describeShapes(const Scene& scene, const LightOptions& options, uint32_t width, uint32_t height) {
  SceneShapes shapes;
  shapes.imports = listImports();
  countGeometry(scene, shapes.counts);
  countLights(setUpLights(scene, options), shapes.counts);
  countSky(scene, shapes.counts);
  shapes.counts["width"] = width;
  shapes.counts["height"] = height;
  return shapes;
}

GpuScene::GpuScene(gpu::Device& device, const Scene& scene, const LightOptions& options) : device_(device), options_(options) {
  options_.maxShadowSide = std::min(options_.maxShadowSide, device.capabilities().maxImageDimension2D);
  options_.maxShadowLayers = std::min(options_.maxShadowLayers, device.capabilities().maxImageArrayLayers);
  checkRange(device, scene, "vertices", scene.vertices.size() * sizeof(shared::Vertex));
  checkRange(device, scene, "indices", scene.indices.size() * sizeof(uint32_t));
  vertices_ = makeBuffer(device, "scene.vertices", scene.vertices);
  indices_ = makeBuffer(device, "scene.indices", scene.indices);
  triangleMaterials_ = makeBuffer(device, "scene.triangle_materials", scene.triangleMaterials);
  materials_ = makeBuffer(device, "scene.materials", clampMaterials(scene.materials));
  uploadTextures(scene);
  countGeometry(scene, counts_);
  setLights(scene);
  setCamera(scene.cameras.empty() ? CameraDescription{} : scene.cameras.front(), 1, 1);
}

void GpuScene::uploadTextures(const Scene& scene) {
  std::vector<shared::Texture> table;
  std::vector<uint32_t> pending;  // texels of textures whose buffer is not made yet
  size_t firstPending = 0;
  const auto flush = [&] {
    if (pending.empty()) return;
    texels_.push_back(makeBuffer(device_, "scene.texels", pending));
    for (size_t i = firstPending; i < table.size(); ++i) {
      const uint64_t address = texels_.back().address() + static_cast<uint64_t>(table[i].address.x) * sizeof(uint32_t);
      table[i].address = {static_cast<uint32_t>(address), static_cast<uint32_t>(address >> 32)};
    }
    firstPending = table.size();
    pending.clear();
  };
  for (const TextureImage& image : scene.textures) {
    const MipChain chain = buildMipChain(image);
    if ((pending.size() + chain.texels.size()) * sizeof(uint32_t) > kTexelBufferBytes) flush();
    shared::Texture entry{};
    entry.address = {static_cast<uint32_t>(pending.size()), 0u};
    entry.width = image.width;
    entry.height = image.height;
    entry.levelCount = chain.levelCount;
    entry.wrapU = image.wrapU;
    entry.wrapV = image.wrapV;
    entry.flags = (image.nearest ? shared::kTextureNearest : 0u) | (image.srgb ? shared::kTextureSrgb : 0u);
    table.push_back(entry);
    pending.insert(pending.end(), chain.texels.begin(), chain.texels.end());
  }
  flush();
  textureTable_ = makeBuffer(device_, "scene.textures", table);
}

void GpuScene::uploadSky(const Scene& scene) {
  if (sky_ && scene.sky == uploadedSky_) return;
  std::vector<glm::vec3> values;
  if (scene.sky) {
    for (const std::vector<glm::vec3>* part : {&scene.sky->bins, &scene.sky->cells, &scene.sky->texels})
      values.insert(values.end(), part->begin(), part->end());
  }
  checkRange(device_, scene, "sky", values.size() * sizeof(glm::vec3));
  sky_ = makeBuffer(device_, "scene.sky", values);
  uploadedSky_ = scene.sky;
  ++skyVersion_;
}

void GpuScene::setGeometry(const Scene& scene) {
  if (scene.vertices.size() != counts_["vertices"] || scene.triangleCount() != counts_["triangles"]) {
    throw Error(ErrorCode::BadInput, scene.name + ": it has " + std::to_string(scene.vertices.size()) + " vertices and " +
                                         std::to_string(scene.triangleCount()) + " triangles where there were " +
                                         std::to_string(counts_["vertices"]) + " and " + std::to_string(counts_["triangles"]) +
                                         "; only moved ones can be set: make another GpuScene");
  }
  vertices_ = makeBuffer(device_, "scene.vertices", scene.vertices);
  ++vertexVersion_;
  emissive_ = {};
  setLights(scene);
}

void GpuScene::setLights(const Scene& scene) {
  const LightSetup setup = setUpLights(scene, options_);
  const Traits traits = scene.traits();
  lights_ = makeHostBuffer(device_, "scene.lights", setup.lights);
  shadowViews_ = makeHostBuffer(device_, "scene.shadow_views", setup.views);
  if (!emissive_) emissive_ = makeBuffer(device_, "scene.emissive_triangles", setup.emissive);
  shared::SceneInfo info{};
  info.boundsMin = traits.boundsMin;
  info.boundsMax = traits.boundsMax;
  info.triangleCount = static_cast<uint32_t>(traits.triangleCount);
  info.lightCount = static_cast<uint32_t>(setup.lights.size());
  info.skyRadiance = scene.skyRadiance;
  info.materialCount = traits.materialCount;
  info.emissiveTriangleCount = static_cast<uint32_t>(setup.emissive.size());
  info.shadowViewCount = static_cast<uint32_t>(setup.views.size());
  info.emissiveArea = static_cast<float>(traits.emissiveArea);
  info.emitterSampleCount = setup.emitterSampleCount;
  if (scene.sky) {
    info.skyWidth = scene.sky->width;
    info.skyHeight = scene.sky->height;
    info.skyTurn = scene.sky->turn;
  }
  uploadSky(scene);
  countSky(scene, counts_);
  info_ = makeHostBuffer(device_, "scene.info", std::vector<shared::SceneInfo>{info});
  countLights(setup, counts_);
  notes_ = setup.notes;
  ++lightVersion_;
}

void GpuScene::setCamera(const CameraDescription& camera, uint32_t width, uint32_t height) {
  const std::vector<shared::Camera> data{makeCamera(camera, width, height)};
  if (camera_)
    std::memcpy(camera_.mapped(), data.data(), sizeof(shared::Camera));
  else
    camera_ = makeHostBuffer(device_, "view.camera", data);
  counts_["width"] = width;
  counts_["height"] = height;
  ++cameraVersion_;
}

void GpuScene::importInto(graph::Executor& executor) const {
  executor.importBuffer("scene.vertices", vertices_, vertexVersion_);
  executor.importBuffer("scene.indices", indices_, geometryVersion_);
  executor.importBuffer("scene.triangle_materials", triangleMaterials_, geometryVersion_);
  executor.importBuffer("scene.materials", materials_, geometryVersion_);
  executor.importBuffer("scene.textures", textureTable_, geometryVersion_);
  executor.importBuffer("scene.emissive_triangles", emissive_, vertexVersion_);
  executor.importBuffer("scene.info", info_, lightVersion_);
  executor.importBuffer("scene.lights", lights_, lightVersion_);
  executor.importBuffer("scene.shadow_views", shadowViews_, lightVersion_);
  executor.importBuffer("scene.sky", sky_, skyVersion_);
  executor.importBuffer("view.camera", camera_, cameraVersion_);
}

std::vector<graph::Import> GpuScene::imports() const { return listImports(); }

graph::Counts GpuScene::counts() const { return counts_; }

}  // namespace radivox::scene
