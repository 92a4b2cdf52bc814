#include "modules/clustered_voxel/visibility/transfer.h"

#include <cassert>

#include "shaders/shared/transfer_entry.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;

namespace {

struct Push {
  uint32_t clusterCount;
  uint32_t faceCount;
  VkDeviceAddress matrix;
  uint32_t weightBits;
};

}  // namespace

Transfer::Transfer()
    : table_({params::choice("lanes", &lanes_, {"auto", "8", "64"},
                             "lanes that make a row together (same result): auto: 8 on CPU devices for clusters of few faces, else 64",
                             params::Invalidates::Plan)}) {}

void Transfer::declare(graph::Declaration& d) {
  // Rows are most of what rays leave behind. Where neither the last bounce nor the sky goes to faces, this is the last to read them, and labels.
  d.read("visibility_row_start", "first bit of each face's row in its chunk").frees = true;
  d.read("visibility_entries", "rows of the faces, by chunk").frees = true;
  d.read("chunk_table", "device address of each chunk").frees = true;
  d.read("faces", "Face");
  d.read("labels", "cluster id of each face").frees = true;
  d.read("clusters", "Cluster");
  d.read("members", "members of the clusters");
  graph::Port& weights = d.read("weights", "how much of each face others see");
  weights.optional = weights.frees = true;
  d.write("row_start", Shape::buffer(4, Extent::of("clusters") + 1), "first entry of each cluster's row");
  d.write("entries", Shape::buffer(4, Extent::of("transfer_entries")), "column and form factor, shared/transfer_entry.h; columns ascend")
      .growable = true;
  d.write("sky", Shape::buffer(4, Extent::of("clusters")), "share of rays that left the scene").optional = true;
  d.publishCount("transfer_entries", "", 0);
  d.scratch("total", Shape::buffer(4, 2), "number of entries, low and high word");
  // Covers Scan::scratchBytes: two words a block of 1024 items, the same for their sums, each level at an aligned offset.
  d.scratch("scan", Shape::buffer(4, Extent::of("clusters") / 256 + 512), "scan");
  d.hostPaced();
}

void Transfer::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  scan_ = std::make_unique<gpu::Scan>(device);
  const auto make = [&](Pipelines& pipelines, uint32_t lanes) {
    pipelines.count = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/visibility/transfer_count.comp",
                                                                     .bindings = {kB, kB, kB, kB, kB, kB},
                                                                     .pushConstantBytes = sizeof(Push),
                                                                     .constants = {{1, lanes}}});
    pipelines.fill = gpu::Pipeline(
        device,
        gpu::ComputePipelineInfo{.shader = "clustered_voxel/visibility/transfer_fill.comp",
                                 .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                 .pushConstantBytes = sizeof(Push),
                                 .constants = {{0, context.has("weights") ? 1u : 0u}, {1, lanes}, {2, context.has("sky") ? 1u : 0u}}});
  };
  const bool isCpu = device.capabilities().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  hasFew_ = lanes_ == Lanes::Eight || (lanes_ == Lanes::Auto && isCpu);
  hasMany_ = lanes_ != Lanes::Eight;
  if (hasFew_) make(few_, 8);
  if (hasMany_) make(many_, 64);
}

void Transfer::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto clusterCount = static_cast<uint32_t>(context.count("clusters"));
  const gpu::Buffer& rowStart = context.buffer("row_start");
  Push push{clusterCount, static_cast<uint32_t>(context.count("faces")), 0, shared::transferWeightBits(clusterCount)};
  const auto b = [&context](const char* name) -> const gpu::Buffer& { return context.buffer(name); };
  // A cluster of Sponza has ten faces: CPU devices, which stop at every barrier once for each vector of lanes, are faster with few lanes. Large
  // clusters want many: Mesa's llvmpipe ends the loops of a lane after 65535 rounds in all.
  constexpr uint64_t kMostFacesForFew = 24;
  const bool few = hasFew_ && (!hasMany_ || context.count("faces") <= kMostFacesForFew * clusterCount);
  const Pipelines& pipelines = few ? few_ : many_;
  if (context.step() == 0) {
    assert(b("scan").bytes() >= gpu::Scan::scratchBytes(clusterCount + 1));
    commands.fill(rowStart, 0);
    commands.barrier();
    commands.bind(pipelines.count, {b("visibility_row_start"), b("chunk_table"), b("labels"), b("clusters"), b("members"), rowStart});
    commands.push(push);
    commands.dispatchItems(clusterCount, 1);  // a group a cluster
    scan_->scan(commands, rowStart, rowStart, clusterCount + 1, b("scan"), &b("total"));
  } else if (clusterCount > 0) {
    push.matrix = context.grown("entries").front()->address();
    commands.bind(pipelines.fill,
                  {b("visibility_row_start"), b("chunk_table"), b("labels"), b("clusters"), b("members"), rowStart, b("faces"),
                   b(context.has("sky") ? "sky" : "row_start"), b(context.has("weights") ? "weights" : "labels")});
    commands.push(push);
    commands.dispatchItems(clusterCount, 1);
  }
}

void Transfer::stepDone(graph::RecordContext& context) {
  if (context.step() != 0) return;
  uint32_t total[2];
  const std::vector<std::byte> words = context.readBuffer("total", 0, sizeof(total));
  std::memcpy(total, words.data(), sizeof(total));
  if (total[1] != 0)
    throw Error(
        ErrorCode::OutOfMemory,
        "clustered_voxel.transfer: the cluster matrix has more than 2^32 entries; raise cluster.spacing or lower voxelize.resolution");
  context.clearGrown("entries");
  context.grow("entries", static_cast<uint64_t>(total[0]) * 4);
  context.setCount("transfer_entries", total[0]);
}

}  // namespace radivox::clustered_voxel
