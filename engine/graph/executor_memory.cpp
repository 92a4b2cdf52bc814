// Allocation when counts are known, alias slots, limits of the device.
#include <algorithm>

#include "engine/graph/executor_impl.h"

namespace radivox::graph {
namespace {

[[noreturn]] void tooLarge(const std::string& name, uint64_t bytes, const char* limitName, uint64_t limit) {
  throw Error(ErrorCode::OutOfMemory,
              name + " needs " + std::to_string(bytes) + " B, more than this device's " + limitName + " of " + std::to_string(limit) +
                  " B: at most " + std::to_string(static_cast<int>(100.0 * static_cast<double>(limit) / static_cast<double>(bytes))) +
                  " % of it fits; use a smaller resolution or scene");
}

uint64_t requireExtent(const Extent& extent, const Counts& counts, const std::string& name) {
  const std::optional<uint64_t> value = extent.evaluate(counts);
  if (!value) throw Error(ErrorCode::BadInput, name + " is shaped by " + extent.print() + ", which is not known when it must be made");
  return *value;
}

}  // namespace

void Executor::Impl::checkBuffer(const std::string& name, uint64_t bytes, bool bound) const {
  const gpu::Capabilities& limits = device.capabilities();
  if (limits.maxBufferSize != 0 && bytes > limits.maxBufferSize) tooLarge(name, bytes, "largest buffer", limits.maxBufferSize);
  if (bound && limits.maxStorageBufferRange != 0 && bytes > limits.maxStorageBufferRange) {
    tooLarge(name, bytes, "largest storage buffer binding", limits.maxStorageBufferRange);
  }
}

uint64_t Executor::Impl::bufferBytes(const std::string& name, const Shape& shape) const {
  const uint64_t elements = requireExtent(shape.elements, counts, name);
  uint64_t bytes = 0;
  if (__builtin_mul_overflow(elements, uint64_t{shape.elementBytes}, &bytes)) {
    throw Error(ErrorCode::OutOfMemory, name + " (" + shape.print() + ") does not fit in 64 bits; use a smaller resolution");
  }
  return bytes;
}

gpu::ImageInfo Executor::Impl::imageInfo(const std::string& name, const Shape& shape) const {
  const gpu::Capabilities& limits = device.capabilities();
  const auto side = [&](const Extent& extent, uint32_t limit, const char* what) {
    const uint64_t value = std::max<uint64_t>(requireExtent(extent, counts, name), 1);
    if (value > (limit != 0 ? limit : 0xffffffffu)) {
      throw Error(ErrorCode::OutOfMemory, name + " needs " + std::to_string(value) + " " + what + ", this device's limit is " +
                                              std::to_string(limit) + "; use a smaller size");
    }
    return static_cast<uint32_t>(value);
  };
  gpu::ImageInfo info;
  info.width = side(shape.width, limits.maxImageDimension2D, "texels a row");
  info.height = side(shape.height, limits.maxImageDimension2D, "rows");
  info.layers = side(shape.layers, limits.maxImageArrayLayers, "layers");
  info.format = shape.format;
  info.arrayView = shape.arrayView;
  return info;
}

void Executor::Impl::allocateOutputs(uint32_t step) {
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (port.resource == kNoResource || (port.access != Access::Write && port.access != Access::ReadBack)) continue;
    allocateOutput(port.resource, port.use);
  }
}

void Executor::Impl::allocateOutput(ResourceId id, uint32_t use) {
  const PlannedResource& planned = plan.resources[id];
  ResourceState& state = resources[id];
  if (planned.growable) {
    state.allocated = true;
    return;
  }
  if (planned.shape.kind == ResourceKind::Buffer) {
    const uint64_t bytes = bufferBytes(planned.name, planned.shape);
    if (state.allocated && state.bytes == bytes) return;
    checkBuffer(planned.name, bytes, (use & (UseCompute | UseRaster)) != 0);
    state.buffer = gpu::Buffer();  // the old one first: both together may not fit
    state.allocated = false;
    state.buffer = gpu::Buffer(device, planned.name, bytes, planned.hostVisible ? gpu::MemoryKind::ReadBack : gpu::MemoryKind::Device);
    state.bytes = bytes;
  } else {
    const gpu::ImageInfo info = imageInfo(planned.name, planned.shape);
    const uint64_t extent[3] = {info.width, info.height, info.layers};
    if (state.allocated && std::equal(extent, extent + 3, state.extent)) return;
    state.image = gpu::Image();
    state.allocated = false;
    state.image = gpu::Image(device, planned.name, info);
    std::copy(extent, extent + 3, state.extent);
    state.bytes = gpu::Image::requirements(device, info).size;
  }
  state.allocated = true;
  state.mustZero = planned.persistent;
  state.access = {};
}

void Executor::Impl::allocateScratch(const std::vector<uint32_t>& batchSteps) {
  struct Need {
    uint64_t bytes = 0;
    uint32_t typeBits = ~0u;
  };
  std::vector<Need> needs(slots.size());
  const auto forEach = [&](auto&& visit) {
    for (const uint32_t step : batchSteps) {
      for (const PlannedPort& port : plan.steps[step].ports) {
        if (port.resource == kNoResource || port.access != Access::Scratch) continue;
        const ResourceId lender = plan.resources[port.resource].lender;
        if (lender != kNoResource) {
          allocateOutput(lender, port.use);
        } else {
          visit(port);
        }
      }
    }
  };
  forEach([&](const PlannedPort& port) {
    const PlannedResource& planned = plan.resources[port.resource];
    VkMemoryRequirements requirements;
    if (planned.shape.kind == ResourceKind::Buffer) {
      const uint64_t bytes = bufferBytes(planned.name, planned.shape);
      checkBuffer(planned.name, bytes, (port.use & (UseCompute | UseRaster)) != 0);
      requirements = gpu::Buffer::requirements(device, bytes);
    } else {
      requirements = gpu::Image::requirements(device, imageInfo(planned.name, planned.shape));
    }
    Need& need = needs[planned.aliasSlot];
    need.bytes = std::max<uint64_t>(need.bytes, requirements.size);
    need.typeBits &= requirements.memoryTypeBits;
  });
  for (uint32_t slot = 0; slot < slots.size(); ++slot) {
    if (needs[slot].bytes <= slots[slot].bytes) continue;
    releaseSlot(slot);
    VkMemoryRequirements requirements{};
    requirements.size = needs[slot].bytes;
    requirements.alignment = 1;  // members start at offset 0
    requirements.memoryTypeBits = needs[slot].typeBits;
    slots[slot].memory = device.allocate(requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, true);
    slots[slot].bytes = needs[slot].bytes;
    slots[slot].access = {};
  }
  forEach([&](const PlannedPort& port) {
    const PlannedResource& planned = plan.resources[port.resource];
    ResourceState& state = resources[port.resource];
    const VkDeviceMemory memory = slots[planned.aliasSlot].memory;
    if (planned.shape.kind == ResourceKind::Buffer) {
      const uint64_t bytes = bufferBytes(planned.name, planned.shape);
      if (state.allocated && state.bytes == bytes) return;
      state.buffer = gpu::Buffer();
      state.buffer = gpu::Buffer(device, planned.name, bytes, memory, 0);
      state.bytes = bytes;
    } else {
      const gpu::ImageInfo info = imageInfo(planned.name, planned.shape);
      const uint64_t extent[3] = {info.width, info.height, info.layers};
      if (state.allocated && std::equal(extent, extent + 3, state.extent)) return;
      state.image = gpu::Image();
      state.image = gpu::Image(device, planned.name, info, memory, 0);
      std::copy(extent, extent + 3, state.extent);
      state.bytes = gpu::Image::requirements(device, info).size;
    }
    state.allocated = true;
  });
}

void Executor::Impl::releaseSlot(uint32_t slot) {
  for (ResourceId id = 0; id < resources.size(); ++id) {
    if (plan.resources[id].aliasSlot != slot) continue;
    resources[id].buffer = gpu::Buffer();
    resources[id].image = gpu::Image();
    resources[id].allocated = false;
  }
  if (slots[slot].memory != VK_NULL_HANDLE) device.free(slots[slot].memory);
  slots[slot] = {};
}

void Executor::Impl::freeScratch(const std::vector<uint32_t>& batchSteps) {
  for (const uint32_t step : batchSteps) {
    for (const PlannedPort& port : plan.steps[step].ports) {
      if (port.resource == kNoResource || plan.resources[port.resource].aliasSlot == kNoSlot) continue;
      releaseSlot(plan.resources[port.resource].aliasSlot);
    }
  }
}

void Executor::Impl::freeRead(uint32_t step) {
  for (const PlannedPort& port : plan.steps[step].ports) {
    if (!port.frees || port.resource == kNoResource) continue;
    ResourceState& state = resources[port.resource];
    state.buffer = gpu::Buffer();
    state.image = gpu::Image();
    state.grown.clear();
    state.bytes = 0;
    state.allocated = false;
    state.access = {};
  }
}

bool Executor::Impl::isAllocated(uint32_t step) const {
  const auto& ports = plan.steps[step].ports;
  return std::all_of(ports.begin(), ports.end(), [&](const PlannedPort& port) {
    return port.resource == kNoResource || plan.resources[port.resource].imported || resources[memoryOf(port.resource)].allocated;
  });
}

}  // namespace radivox::graph
