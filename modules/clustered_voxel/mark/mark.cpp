#include "modules/clustered_voxel/mark/mark.h"

#include "modules/clustered_voxel/structure.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Mark::Mark()
    : table_(
          {params::number("reach", &reach_, {0, 16}, "voxels about a shown face that the filter may read (radius × passes of the filter)",
                          params::Invalidates::Rerun)}) {}

void Mark::declare(graph::Declaration& d) {
  d.read("position", "relative world m, w: distance along the view axis, 0: sky");
  d.read("normal", "unit shading normal");
  declareStructure(d);
  d.write("shown", Shape::buffer(4, Extent::of("faces") / 32), "bit per face: in some pixel's stencil");
  d.write("needed", Shape::buffer(4, Extent::of("faces") / 32), "bit per face: shown, or within the filter's reach of one");
  d.readBack("status", Shape::buffer(4, 2), "shown, needed faces");
}

void Mark::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  gpu::Device& device = context.device();
  mark_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{
                  .shader = "clustered_voxel/mark/mark.comp", .bindings = {kB, kB, kB, kB, kB, kB, kI, kI, kB}, .pushConstantBytes = 8});
  reachPipeline_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{
                  .shader = "clustered_voxel/mark/reach.comp", .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB}, .pushConstantBytes = 8});
  countBits_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/mark/count_bits.comp", .bindings = {kB, kB, kB}, .pushConstantBytes = 4});
}

void Mark::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& shown = context.buffer("shown");
  const gpu::Buffer& needed = context.buffer("needed");
  const gpu::Buffer& status = context.buffer("status");
  commands.fill(shown, 0);
  commands.fill(needed, 0);
  commands.fill(status, 0);
  if (faceCount == 0) return;
  commands.barrier();
  const gpu::Image& position = context.image("position");
  struct {
    uint32_t a, b;
  } push{position.info().width, position.info().height};
  bindStructure(context, mark_, {position, context.image("normal"), shown});
  commands.push(push);
  commands.dispatchItems(uint64_t{push.a} * push.b, 64);
  commands.barrier();
  if (reach_ == 0) {
    commands.copy(shown, needed, uint64_t{(faceCount + 31) / 32} * 4);
  } else {
    bindStructure(context, reachPipeline_, {context.buffer("voxels"), shown, needed});
    push = {faceCount, reach_};
    commands.push(push);
    commands.dispatchItems(faceCount, 64);
  }
  commands.barrier();
  commands.bind(countBits_, {shown, needed, status});
  commands.push((faceCount + 31) / 32);
  commands.dispatchItems((faceCount + 31) / 32, 64);
}

void Mark::frameDone(graph::RecordContext& context) {
  uint32_t words[2];
  std::memcpy(words, context.buffer("status").mapped(), sizeof(words));
  context.reportStat("shown_faces", words[0]);
  context.reportStat("needed_faces", words[1]);
}

}  // namespace radivox::clustered_voxel
