#include "samples/viewer/ports.h"

namespace radivox::viewer {

std::vector<std::string> Ports::endpoints(std::string_view type, std::string_view port) const {
  std::vector<std::string> found;
  for (const graph::Graph::Entry& entry : graph_.nodes()) {
    if (entry.node->type() == type) found.push_back(entry.name + "." + std::string(port));
  }
  return found;
}

const gpu::Buffer* Ports::buffer(std::string_view type, std::string_view port) const {
  for (const std::string& endpoint : endpoints(type, port)) {
    if (const gpu::Buffer* buffer = executor_.findBuffer(endpoint)) return buffer;
  }
  return nullptr;
}

gpu::Image* Ports::image(std::string_view type, std::string_view port) const {
  for (const std::string& endpoint : endpoints(type, port)) {
    if (gpu::Image* image = executor_.findImage(endpoint)) return image;
  }
  return nullptr;
}

std::vector<const gpu::Buffer*> Ports::grown(std::string_view type, std::string_view port) const {
  for (const std::string& endpoint : endpoints(type, port)) {
    std::vector<const gpu::Buffer*> buffers = executor_.findGrown(endpoint);
    if (!buffers.empty()) return buffers;
  }
  return {};
}

graph::Node* Ports::node(std::string_view type) const {
  for (const graph::Graph::Entry& entry : graph_.nodes()) {
    if (entry.node->type() == type) return entry.node.get();
  }
  return nullptr;
}

uint64_t Ports::count(const std::string& name) const {
  const auto found = executor_.counts().find(name);
  return found == executor_.counts().end() ? 0 : found->second;
}

}  // namespace radivox::viewer
