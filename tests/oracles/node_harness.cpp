#include "tests/oracles/node_harness.h"

#include <stdexcept>

namespace radivox::oracles {

NodeHarness::NodeHarness(gpu::Device& device, scene::Traits traits, scene::Request request)
    : device_(device), traits_(std::move(traits)), request_(std::move(request)) {
  counts_ = {
      {"triangles", traits_.triangleCount}, {"vertices", traits_.vertexCount}, {"width", request_.width}, {"height", request_.height}};
}

NodeHarness::~NodeHarness() = default;

void NodeHarness::importBytes(const std::string& name, const void* data, size_t bytes, uint32_t elementBytes) {
  const auto known = buffers_.find(name);
  if (known == buffers_.end() || known->second.own.bytes() < bytes) {
    if (executor_ != nullptr) throw std::logic_error("import " + name + " cannot grow after the first run");
    buffers_[name].own = gpu::Buffer(device_, name, bytes);
    buffers_[name].buffer = &buffers_[name].own;
  }
  ImportedBuffer& import = buffers_[name];
  import.elementBytes = elementBytes;
  ++import.version;
  if (bytes > 0) gpu::upload(device_, import.own, std::span(static_cast<const std::byte*>(data), bytes));
}

void NodeHarness::importPixels(const std::string& name, const gpu::ImageInfo& info, const void* data, size_t bytes) {
  ImportedImage& import = images_[name];
  if (!import.own) import.own = gpu::Image(device_, name, info);
  import.image = &import.own;
  ++import.version;
  gpu::Buffer staging(device_, name + " staging", bytes, gpu::MemoryKind::Upload);
  std::memcpy(staging.mapped(), data, bytes);
  gpu::DescriptorPool pool(device_);
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands(device_, handle, pool).transition(import.own, VK_IMAGE_LAYOUT_GENERAL);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, info.layers};
    region.imageExtent = {info.width, info.height, 1};
    vkCmdCopyBufferToImage(handle, staging.handle(), import.own.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &region);
  });
}

void NodeHarness::importBuffer(const std::string& name, const gpu::Buffer& buffer, uint64_t version) {
  buffers_[name].buffer = &buffer;
  buffers_[name].version = version;
}

void NodeHarness::importImage(const std::string& name, gpu::Image& image, uint64_t version) {
  images_[name].image = &image;
  images_[name].version = version;
}

graph::Node& NodeHarness::add(const std::string& name, std::unique_ptr<graph::Node> node) { return graph_.add(name, std::move(node)); }
void NodeHarness::connect(const std::string& from, const std::string& to) { graph_.connect(from, to); }
void NodeHarness::output(const std::string& nodePort) { graph_.output(nodePort); }
void NodeHarness::setCount(const std::string& name, uint64_t value) { counts_[name] = value; }

void NodeHarness::set(const std::string& nodeParam, const std::string& value) {
  if (graph_.set(nodeParam, value) == params::Invalidates::Plan) executor_.reset();
}

void NodeHarness::compile() {
  std::vector<graph::Import> imports;
  for (const auto& [name, import] : buffers_) {
    imports.push_back({name, graph::Shape::buffer(import.elementBytes, import.buffer->bytes() / import.elementBytes)});
  }
  for (const auto& [name, import] : images_) {
    const gpu::ImageInfo& info = import.image->info();
    imports.push_back({name, graph::Shape::image(info.format, info.width, info.height, info.layers, info.arrayView)});
  }
  graph::Plan plan = graph::compile(graph_, {traits_, request_, device_.capabilities(), std::move(imports), counts_});
  executor_ = std::make_unique<graph::Executor>(device_, graph_, std::move(plan), traits_, request_, counts_);
}

void NodeHarness::run(const graph::Progress& progress) {
  if (executor_ == nullptr) compile();
  for (auto& [name, import] : buffers_) executor_->importBuffer(name, *import.buffer, import.version);
  for (auto& [name, import] : images_) executor_->importImage(name, *import.image, import.version);
  executor_->run(progress);
}

graph::Executor& NodeHarness::executor() {
  if (executor_ == nullptr) throw std::logic_error("run() first");
  return *executor_;
}

bool NodeHarness::has(const std::string& nodePort) {
  return executor().findBuffer(nodePort) != nullptr || executor().findImage(nodePort) != nullptr || !executor().findGrown(nodePort).empty();
}

const gpu::Buffer& NodeHarness::buffer(const std::string& nodePort) {
  const gpu::Buffer* found = executor().findBuffer(nodePort);
  if (found == nullptr) throw std::logic_error("no buffer " + nodePort + " (is it an output?)");
  return *found;
}

gpu::Image& NodeHarness::image(const std::string& nodePort) {
  gpu::Image* found = executor().findImage(nodePort);
  if (found == nullptr) throw std::logic_error("no image " + nodePort + " (is it an output?)");
  return *found;
}

uint64_t NodeHarness::count(const std::string& name) { return executor().counts().at(name); }

/// As asked for, not as allocated: a buffer for 0 elements is 16 bytes long.
uint64_t NodeHarness::bytes(const std::string& nodePort) {
  const size_t dot = nodePort.find('.');
  const graph::PlannedPort* port = executor().plan().findPort(nodePort.substr(0, dot), nodePort.substr(dot + 1));
  if (port == nullptr || port->resource == graph::kNoResource) throw std::logic_error("no buffer " + nodePort);
  const graph::Shape& shape = executor().plan().resources[port->resource].shape;
  return shape.elements.evaluate(executor().counts()).value_or(0) * shape.elementBytes;
}

double NodeHarness::figure(const std::string& node, const std::string& stat) {
  for (const graph::NodeStats& stats : executor().stats().nodes) {
    if (stats.name == node) return stats.figures.at(stat);
  }
  throw std::logic_error("no node " + node);
}

uint32_t NodeHarness::runCount(const std::string& node) {
  for (const graph::NodeStats& stats : executor().stats().nodes) {
    if (stats.name == node) return stats.runCount;
  }
  throw std::logic_error("no node " + node);
}

}  // namespace radivox::oracles
