#include "tests/frame/frame_fixture.h"

#include <cstdlib>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "modules/modules.h"

namespace radivox::frame_test {

SceneBuilder::SceneBuilder() {
  scene.name = "test";
  addMaterial(glm::vec3(0.5f));
  scene.cameras.emplace_back();
}

uint32_t SceneBuilder::addMaterial(const glm::vec3& albedo, const glm::vec3& emission, uint32_t flags) {
  shared::Material material{};
  material.albedo = albedo;
  material.alpha = 1.f;
  material.emission = emission;
  material.alphaCutoff = 0.5f;
  material.baseTexture = material.emissiveTexture = shared::kNoTexture;
  material.flags = flags | (emission != glm::vec3(0.f) ? shared::kMaterialEmissive : 0u);
  scene.materials.push_back(material);
  scene.materialNames.push_back("material " + std::to_string(scene.materials.size()));
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

void SceneBuilder::addTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint32_t material) {
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  for (const glm::vec3& p : {a, b, c}) {
    scene.indices.push_back(static_cast<uint32_t>(scene.vertices.size()));
    scene.vertices.push_back({p, normal, glm::vec2(0.f), glm::vec2(0.f)});
  }
  scene.triangleMaterials.push_back(material);
}

void SceneBuilder::addQuad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, uint32_t material) {
  const auto first = static_cast<uint32_t>(scene.vertices.size());
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const glm::vec3 corners[] = {a, b, c, d};
  const glm::vec2 uvs[] = {{0.f, 1.f}, {1.f, 1.f}, {1.f, 0.f}, {0.f, 0.f}};
  for (int k = 0; k < 4; ++k) scene.vertices.push_back({corners[k], normal, uvs[k], uvs[k]});
  for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + k);
  scene.triangleMaterials.insert(scene.triangleMaterials.end(), 2, material);
}

void SceneBuilder::addBox(const glm::vec3& l, const glm::vec3& h, uint32_t material) {
  addQuad({l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, material);
  addQuad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z}, material);
  addQuad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, material);
  addQuad({h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z}, material);
  addQuad({h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, material);
  addQuad({l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}, material);
}

void SceneBuilder::addSun(const glm::vec3& direction, const glm::vec3& irradiance) {
  scene::PunctualLight light;
  light.type = shared::kLightDirectional;
  light.direction = glm::normalize(direction);
  light.intensity = irradiance;
  scene.lights.push_back(light);
}

void SceneBuilder::addPoint(const glm::vec3& position, const glm::vec3& intensity, float range) {
  scene::PunctualLight light;
  light.type = shared::kLightPoint;
  light.position = position;
  light.intensity = intensity;
  light.range = range;
  scene.lights.push_back(light);
}

void SceneBuilder::addSpot(const glm::vec3& position, const glm::vec3& direction, const glm::vec3& intensity, float inner, float outer) {
  scene::PunctualLight light;
  light.type = shared::kLightSpot;
  light.position = position;
  light.direction = glm::normalize(direction);
  light.intensity = intensity;
  light.innerConeAngle = inner;
  light.outerConeAngle = outer;
  scene.lights.push_back(light);
}

void SceneBuilder::lookAt(const glm::vec3& from, const glm::vec3& to, float yfov) {
  scene::CameraDescription& camera = scene.cameras.front();
  const glm::vec3 forward = glm::normalize(to - from);
  const glm::vec3 up = std::abs(forward.y) > 0.99f ? glm::vec3(0.f, 0.f, -1.f) : glm::vec3(0.f, 1.f, 0.f);
  camera.position = from;
  camera.orientation = glm::quatLookAt(forward, up);
  camera.yfov = yfov;
}

void SceneBuilder::lookParallel(const glm::vec3& from, const glm::vec3& to, float ymag) {
  lookAt(from, to);
  scene.cameras.front().orthographic = true;
  scene.cameras.front().ymag = ymag;
}

FrameRun::FrameRun(gpu::Device& device, const scene::Scene& scene, const FrameOptions& options) : device_(device) {
  plugin::Registry registry;
  registerModules(registry);
  graph = std::make_unique<graph::Graph>();
  for (const char* name : {"shadow_map", "gbuffer", "direct", "composite", "tone_map"})
    graph->add(name, registry.make(std::string("frame.") + name));
  for (const char* port : {"position", "normal", "triangle"}) graph->connect(std::string("gbuffer.") + port, std::string("direct.") + port);
  graph->connect("shadow_map.depth", "direct.shadow_depth");
  graph->connect("shadow_map.triangle", "direct.shadow_triangle");
  for (const char* port : {"albedo", "emission"}) graph->connect(std::string("gbuffer.") + port, std::string("composite.") + port);
  graph->connect("direct.irradiance", "composite.irradiance");
  graph->connect("composite.color", "tone_map.color");
  if (options.voxels > 0) {
    for (const char* name : {"voxelize", "index", "triangles"}) graph->add(name, registry.make(std::string("clustered_voxel.") + name));
    for (const char* reader : {"index", "triangles", "direct"})
      for (const char* port : {"grid", "occupancy"}) graph->connect(std::string("voxelize.") + port, std::string(reader) + "." + port);
    for (const char* reader : {"triangles", "direct"}) graph->connect("index.rank", std::string(reader) + ".rank");
    graph->connect("index.voxels", "triangles.voxels");
    graph->connect("index.distance", "direct.distance");
    for (const char* port : {"first", "ids"}) graph->connect(std::string("triangles.") + port, std::string("direct.triangle_") + port);
    graph->connect("triangles.corners", "direct.corners");
    graph->set("voxelize.resolution", std::to_string(options.voxels));
  }
  for (const auto& [name, value] : options.settings) graph->set(name, value);
  for (const std::string& output : options.outputs) graph->output(output);

  const scene::Traits traits = scene::traitsFor(scene, options.lights);
  scene::Request request;
  request.width = options.width;
  request.height = options.height;
  request.bounces = options.bounces;
  gpuScene = std::make_unique<scene::GpuScene>(device, scene, options.lights);
  gpuScene->setCamera(scene.cameras.front(), options.width, options.height);
  graph::Plan plan = graph::compile(*graph, {traits, request, device.capabilities(), gpuScene->imports(), gpuScene->counts()});
  executor = std::make_unique<graph::Executor>(device, *graph, std::move(plan), traits, request, gpuScene->counts());
  gpuScene->importInto(*executor);
  executor->run();
}

namespace {

gpu::Image& findImage(graph::Executor& executor, const std::string& nodePort) {
  gpu::Image* image = executor.findImage(nodePort);
  if (image == nullptr) throw Error(ErrorCode::BadInput, "no image " + nodePort);
  return *image;
}

template <class T>
std::vector<T> downloadImage(gpu::Device& device, gpu::Image& image, uint32_t layer) {
  const auto raw = gpu::download(device, image, layer);
  std::vector<T> out(raw.size() / sizeof(T));
  std::memcpy(out.data(), raw.data(), out.size() * sizeof(T));
  return out;
}

}  // namespace

std::vector<glm::vec4> FrameRun::pixels(const std::string& nodePort) {
  return downloadImage<glm::vec4>(device_, findImage(*executor, nodePort), 0);
}

std::vector<uint32_t> FrameRun::words(const std::string& nodePort, uint32_t layer) {
  return downloadImage<uint32_t>(device_, findImage(*executor, nodePort), layer);
}

std::vector<float> FrameRun::depths(const std::string& nodePort, uint32_t layer) {
  return downloadImage<float>(device_, findImage(*executor, nodePort), layer);
}

image::Image FrameRun::picture(const std::string& nodePort) {
  const auto from = pixels(nodePort);
  image::Image out;
  out.width = findImage(*executor, nodePort).info().width;
  out.height = findImage(*executor, nodePort).info().height;
  for (const glm::vec4& p : from) out.data.insert(out.data.end(), {p.x, p.y, p.z});
  return out;
}

double FrameRun::figure(const std::string& node, const std::string& name) const {
  for (const graph::NodeStats& stats : executor->stats().nodes)
    if (stats.name == node && stats.figures.contains(name)) return stats.figures.at(name);
  throw Error(ErrorCode::BadInput, "no figure " + node + "." + name);
}

std::string FrameRun::culledReason(const std::string& node) const {
  for (const graph::CulledNode& culled : executor->plan().culled)
    if (culled.name == node) return culled.reason;
  return {};
}

std::unique_ptr<graph::Node> makeNode(const std::string& type) {
  plugin::Registry registry;
  registerModules(registry);
  return registry.make(type);
}

void show(const image::Image& linear, const std::string& name) {
  const char* folder = std::getenv("RADIVOX_TEST_IMAGES");
  if (folder == nullptr) return;
  image::writePng(std::string(folder) + "/" + name + ".png", image::scaled(linear, image::exposureOf(linear)));
}

}  // namespace radivox::frame_test
