#include "modules/clustered_voxel/lazy_faces.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;

void LazyFaces::declare(graph::Declaration& d) {
  d.write("valid", Shape::buffer(4, Extent::of("faces") / 32), "bit per face: up to date").persistent = true;
  d.readBack("status", Shape::buffer(4, 4), "faces of this run, then dispatch arguments");
  d.scratch("todo", Shape::buffer(4, Extent::of("faces") / 32), "bit per face");
  d.scratch("list", Shape::buffer(4, Extent::of("faces")), "faces of this run");
  // Bytes that Scan::compactBits wants: bounded by 4 words a word of bits and one block.
  d.scratch("scan", Shape::buffer(16, Extent::of("faces") / 32 + 1024), "compaction");
}

void LazyFaces::prepare(gpu::Device& device) {
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  scan_ = std::make_unique<gpu::Scan>(device);
  select_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather/select.comp", .bindings = {kB, kB, kB}, .pushConstantBytes = 12});
}

bool LazyFaces::record(graph::RecordContext& context, const gpu::Buffer& wanted, bool all, bool stale) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& valid = context.buffer("valid");
  const gpu::Buffer& status = context.buffer("status");
  if (faceCount == 0) {
    commands.fill(status, 0);
    return false;
  }
  if (stale) {
    commands.fill(valid, 0);
    commands.barrier();
  }
  struct {
    uint32_t wordCount, faceCount, all;
  } push{(faceCount + 31) / 32, faceCount, all ? 1u : 0u};
  commands.bind(select_, {wanted, valid, context.buffer("todo")});
  commands.push(push);
  commands.dispatchItems(push.wordCount, 64);
  commands.barrier();
  scan_->compactBits(commands, context.buffer("todo"), faceCount, context.buffer("list"), status, 64, context.buffer("scan"));
  commands.barrier();
  return true;
}

}  // namespace radivox::clustered_voxel
