#include <algorithm>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {
namespace {

[[noreturn]] void misuse(const std::string& node, const std::string& what) {
  throw Error(ErrorCode::BadInput, "node " + node + " " + what + "; this is a mistake in the node");
}

}  // namespace

size_t StepContext::portIndex(std::string_view port) const {
  const auto& ports = impl_.plan.steps[step_].ports;
  for (size_t i = 0; i < ports.size(); ++i) {
    if (ports[i].name == port) return i;
  }
  misuse(impl_.nodeName(step_), "asks for port " + std::string(port) + ", which it did not declare");
}

ResourceId StepContext::resource(std::string_view port) const {
  const ResourceId id = impl_.plan.steps[step_].ports[portIndex(port)].resource;
  if (id == kNoResource) misuse(impl_.nodeName(step_), "asks for port " + std::string(port) + ", which is absent: ask has() first");
  return id;
}

gpu::Commands& StepContext::commands() {
  if (current == nullptr) misuse(impl_.nodeName(step_), "asks for commands outside record");
  return *current;
}

bool StepContext::has(std::string_view port) const { return impl_.plan.steps[step_].ports[portIndex(port)].resource != kNoResource; }

const gpu::Buffer& StepContext::buffer(std::string_view port) {
  const ResourceId id = resource(port);
  const PlannedResource& planned = impl_.plan.resources[id];
  if (planned.shape.kind != ResourceKind::Buffer) misuse(impl_.nodeName(step_), "asks for image " + std::string(port) + " as a buffer");
  if (planned.growable) misuse(impl_.nodeName(step_), "asks for growable port " + std::string(port) + " as one buffer: use grown()");
  return impl_.bufferOf(id);
}

gpu::Image& StepContext::image(std::string_view port) {
  const ResourceId id = resource(port);
  if (impl_.plan.resources[id].shape.kind != ResourceKind::Image) {
    misuse(impl_.nodeName(step_), "asks for buffer " + std::string(port) + " as an image");
  }
  return impl_.imageOf(id);
}

uint64_t StepContext::count(std::string_view name) const {
  const auto known = std::find_if(impl_.counts.begin(), impl_.counts.end(), [&](const auto& c) { return c.first == name; });
  if (known == impl_.counts.end()) {
    misuse(impl_.nodeName(step_), "asks for the count " + std::string(name) + " before it is known: shape a port by it");
  }
  return known->second;
}

bool StepContext::changed(std::string_view inputPort) const {
  const StepState& state = impl_.steps[step_];
  const size_t port = portIndex(inputPort);
  return state.firstRun || state.seen[port] != state.seenBefore[port];
}

ResourceState& StepContext::growable(std::string_view port) {
  const PlannedPort& planned = impl_.plan.steps[step_].ports[portIndex(port)];
  const ResourceId id = resource(port);
  if (planned.access == Access::Read || !impl_.plan.resources[id].growable) {
    misuse(impl_.nodeName(step_), "grows port " + std::string(port) + ", which it did not declare as a growable output");
  }
  return impl_.resources[id];
}

const gpu::Buffer& StepContext::grow(std::string_view port, uint64_t bytes) {
  ResourceState& state = growable(port);
  const std::string name = impl_.nodeName(step_) + "." + std::string(port) + "[" + std::to_string(state.grown.size()) + "]";
  impl_.checkBuffer(name, bytes, false);
  state.grown.push_back(std::make_unique<gpu::Buffer>(impl_.device, name, bytes));
  state.bytes += bytes;
  state.allocated = true;
  return *state.grown.back();
}

void StepContext::clearGrown(std::string_view port) {
  ResourceState& state = growable(port);
  state.grown.clear();
  state.bytes = 0;
}

std::vector<const gpu::Buffer*> StepContext::grown(std::string_view port) const {
  std::vector<const gpu::Buffer*> buffers;
  for (const auto& buffer : impl_.resources[resource(port)].grown) buffers.push_back(buffer.get());
  return buffers;
}

std::vector<std::byte> StepContext::readBuffer(std::string_view port, uint64_t offset, uint64_t bytes) {
  if (current != nullptr) misuse(impl_.nodeName(step_), "reads back while it records");
  return gpu::download(impl_.device, buffer(port), offset, bytes);
}

void StepContext::setCount(std::string_view name, uint64_t value) {
  for (const auto& published : impl_.plan.steps[step_].counts) {
    if (published.name != name) continue;
    impl_.counts[published.name] = value;
    return;
  }
  misuse(impl_.nodeName(step_),
         "sets the count " + std::string(name) + " without having declared it: publishCount(\"" + std::string(name) + "\", \"\", 0)");
}

void StepContext::reportProgress(double fraction) {
  reportedProgress = true;
  if (impl_.progress) impl_.progress(impl_.nodeName(step_), fraction);
}

void StepContext::reportStat(std::string_view name, double value) {
  auto& figures = impl_.steps[step_].stats.figures;
  const auto known = std::find_if(figures.begin(), figures.end(), [&](const auto& f) { return f.first == name; });
  if (known != figures.end()) {
    known->second = value;
  } else {
    figures.emplace(std::string(name), value);
  }
}

}  // namespace radivox::graph
