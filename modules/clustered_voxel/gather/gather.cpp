#include "modules/clustered_voxel/gather/gather.h"

#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Gather::Gather()
    : table_(
          {params::choice("estimator", &estimator_, {"counted", "differential"},
                          "counted: form factors from ray counts; differential: the paper's cosθ cosθ'/(π d²)", params::Invalidates::Plan),
           params::flag("lazy", &lazy_, "gather only the faces that the view needs; off: all of them (tests)",
                        params::Invalidates::Rerun)}) {}

void Gather::declare(graph::Declaration& d) {
  if (estimator_ == Estimator::Differential && d.request.aovs.count("error") != 0)
    throw Error(
        ErrorCode::BadInput,
        "gather.estimator=differential has no ray counts to tell an error by; leave AOV error out, or use gather.estimator=counted");
  d.read("needed", "bit per face");
  d.read("row_start", "first entry of each face's row in its chunk");
  d.read("entries", "visibility entries");
  d.read("chunk_table", "device address of each chunk");
  d.read("faces", "Face");
  d.read("voxels", "packed coordinate of each voxel");
  d.read("clusters", "Cluster");
  d.read("cluster_radiosity", "reflected radiosity, W/m²");
  d.read("face_radiosity", "reflected radiosity, W/m²");
  d.write("irradiance", Shape::buffer(16, Extent::of("faces")), "E_indirect, W/m²; a: sky visibility").persistent = true;
  d.write("valid", Shape::buffer(4, Extent::of("faces") / 32), "bit per face: gathered under the present light").persistent = true;
  graph::Port& error = d.write("error", Shape::buffer(12, Extent::of("faces")), "standard error of E_indirect, W/m²");
  error.persistent = true;
  error.optional = true;
  d.readBack("status", Shape::buffer(4, 4), "faces gathered by this run, then dispatch arguments");
  d.scratch("todo", Shape::buffer(4, Extent::of("faces") / 32), "bit per face");
  d.scratch("list", Shape::buffer(4, Extent::of("faces")), "faces to gather");
  // Bytes that Scan::compactBits wants: bounded by 4 words a word of bits and one block.
  d.scratch("scan", Shape::buffer(16, Extent::of("faces") / 32 + 1024), "compaction");
}

void Gather::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  gpu::Device& device = context.device();
  scan_ = std::make_unique<gpu::Scan>(device);
  select_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather/select.comp", .bindings = {kB, kB, kB}, .pushConstantBytes = 12});
  gather_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather/gather.comp",
                                       .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                       .pushConstantBytes = 8,
                                       .constants = {{0, static_cast<uint32_t>(estimator_)}, {1, context.has("error") ? 1u : 0u}}});
}

void Gather::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& valid = context.buffer("valid");
  const gpu::Buffer& status = context.buffer("status");
  if (faceCount == 0) {
    commands.fill(status, 0);
    return;
  }
  // Only a new view leaves earlier results standing.
  const bool stale = context.firstRun() || context.changed("cluster_radiosity") || context.changed("face_radiosity") ||
                     context.changed("entries") || context.changed("row_start") || context.changed("chunk_table") ||
                     context.changed("faces") || context.changed("clusters") || context.changed("voxels");
  if (stale) {
    commands.fill(valid, 0);
    commands.barrier();
  }
  struct {
    uint32_t wordCount, faceCount, all;
  } selectPush{(faceCount + 31) / 32, faceCount, lazy_ ? 0u : 1u};
  commands.bind(select_, {context.buffer("needed"), valid, context.buffer("todo")});
  commands.push(selectPush);
  commands.dispatchItems(selectPush.wordCount, 64);
  commands.barrier();
  scan_->compactBits(commands, context.buffer("todo"), faceCount, context.buffer("list"), status, 64, context.buffer("scan"));
  commands.barrier();
  commands.bind(gather_,
                {context.buffer("list"), status, context.buffer("row_start"), context.buffer("chunk_table"), context.buffer("clusters"),
                 context.buffer("cluster_radiosity"), context.buffer("face_radiosity"), context.buffer("faces"), context.buffer("voxels"),
                 context.buffer("irradiance"), context.buffer(context.has("error") ? "error" : "irradiance")});
  struct {
    uint32_t clusterCount, faceCount;
  } push{static_cast<uint32_t>(context.count("clusters")), faceCount};
  commands.push(push);
  commands.dispatchIndirect(status, 4);
}

void Gather::frameDone(graph::RecordContext& context) {
  uint32_t gathered = 0;
  std::memcpy(&gathered, context.buffer("status").mapped(), sizeof(gathered));
  context.reportStat("gathered_faces", gathered);
}

}  // namespace radivox::clustered_voxel
