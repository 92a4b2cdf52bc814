#include "gi.h"

#include <fstream>
#include <iterator>

#include "modules/clustered_voxel/nodes.h"
#include "modules/frame/nodes.h"

using namespace radivox;

namespace {

const char* const kImports[HostGBuffer::Count] = {"host.position", "host.normal", "host.albedo", "host.emission", "host.triangle"};

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::BadInput, path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

Gi::Gi(const Host& host, HostGBuffer& gbuffer, const scene::Scene& scene, const DeviceWishes& enabled, const std::string& module)
    : width_(host.width), height_(host.height), gbuffer_(gbuffer) {
  // 1. The host's device. Everything stays the host's.
  gpu::AdoptInfo adopt;
  adopt.instance = host.instance;
  adopt.physicalDevice = host.physicalDevice;
  adopt.device = host.device;
  adopt.queue = host.queue;
  adopt.queueFamily = host.queueFamily;
  adopt.deviceExtensions = {enabled.extensions.begin(), enabled.extensions.end()};
  adopt.enabledFeatures = enabled.features;
  device_ = gpu::Device::adopt(adopt);

  // 2. The graph: the host draws its own G-buffer, so that node goes, and what read it reads the host's images.
  frame::registerNodes(registry_);
  clustered_voxel::registerNodes(registry_);
  graph_ = graph::Graph::fromJson(readFile(GRAPH_FILE), GRAPH_FILE, registry_);
  graph_.replaceByImports("gbuffer", "host");
  graph_.set("voxelize.resolution", "64");
  if (!module.empty()) {
    registry_.load(module);
    graph_.add("fog", registry_.make("sample.fog"));
    graph_.connect("composite.color", "fog.color");
    graph_.connect("host.position", "fog.position");
    output_ = "fog.color_in_fog";
  }
  graph_.clearOutputs();
  graph_.output(output_);

  // 3. The scene's triangles, materials and lights on the device; voxels are made of them.
  gpuScene_ = std::make_unique<scene::GpuScene>(*device_, scene);
  moveCamera(scene.cameras[0]);

  // 4. The plan, from what this scene and device need.
  request_.width = width_;
  request_.height = height_;
  traits_ = scene::traitsFor(scene, {});
  std::vector<graph::Import> imports = gpuScene_->imports();
  for (int i = 0; i < HostGBuffer::Count; ++i) {
    imports.push_back(
        {kImports[i], graph::Shape::image(gbuffer.images[i].format, graph::Extent::of("width"), graph::Extent::of("height"))});
  }
  graph::Plan plan = graph::compile(graph_, {traits_, request_, device_->capabilities(), imports, gpuScene_->counts()});
  executor_ = std::make_unique<graph::Executor>(*device_, graph_, std::move(plan), traits_, request_, gpuScene_->counts());
}

void Gi::importFrame() {
  imports_.clear();
  imports_.reserve(HostGBuffer::Count);  // the executor keeps their addresses
  ++frame_;
  for (int i = 0; i < HostGBuffer::Count; ++i) {
    const HostImage& image = gbuffer_.images[i];
    // As the host leaves it; Radivox brings it to GENERAL.
    imports_.emplace_back(image.image, image.view, gpu::ImageInfo{.width = width_, .height = height_, .format = image.format},
                          VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    executor_->importImage(kImports[i], imports_.back(), frame_);
  }
  gpuScene_->importInto(*executor_);
}

bool Gi::record(VkCommandBuffer commands) {
  importFrame();
  if (!executor_->isReadyToRecord()) return false;
  executor_->record(commands);
  return true;
}

VkImage Gi::picture() { return executor_->findImage(output_)->handle(); }
