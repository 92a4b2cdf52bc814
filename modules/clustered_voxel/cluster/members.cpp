#include "modules/clustered_voxel/cluster/members.h"

#include <cassert>

#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kGroup = 64;
}

void Members::declare(graph::Declaration& d) {
  d.read("voxels", "packed coordinate of each voxel");
  d.read("faces", "Face");
  d.read("labels", "cluster id of each face");
  d.write("clusters", Shape::buffer(sizeof(shared::Cluster), Extent::of("clusters") + 1), "Cluster, and where the members of the last end");
  d.write("places", Shape::buffer(sizeof(shared::ClusterPlace), Extent::of("clusters")), "ClusterPlace; grid space, h²").optional = true;
  d.write("members", Shape::buffer(4, Extent::of("faces")), "face ids by cluster, ascending within each");
  d.scratch("starts", Shape::buffer(4, Extent::of("clusters") + 1), "first member of each cluster");
  d.scratch("cursors", Shape::buffer(4, Extent::of("clusters")), "filling level of each cluster");
  // Covers Scan::scratchBytes: two words a block of 1024 items, the same for their sums, each level at an aligned offset.
  d.scratch("scan", Shape::buffer(4, Extent::of("clusters") / 256 + 512), "scan");
}

void Members::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  scan_ = std::make_unique<gpu::Scan>(device);
  count_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{
                                     .shader = "clustered_voxel/cluster/count_members.comp", .bindings = {kB, kB}, .pushConstantBytes = 4});
  place_ = gpu::Pipeline(device,
                         gpu::ComputePipelineInfo{
                             .shader = "clustered_voxel/cluster/place_members.comp", .bindings = {kB, kB, kB, kB}, .pushConstantBytes = 4});
  describe_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/cluster/describe.comp",
                                                             .bindings = {kB, kB, kB, kB, kB, kB},
                                                             .pushConstantBytes = 4,
                                                             .constants = {{0, context.has("places") ? 1u : 0u}}});
}

void Members::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const auto clusterCount = static_cast<uint32_t>(context.count("clusters"));
  if (faceCount == 0) return;
  const gpu::Buffer& starts = context.buffer("starts");
  const gpu::Buffer& cursors = context.buffer("cursors");
  const gpu::Buffer& members = context.buffer("members");
  const gpu::Buffer& labels = context.buffer("labels");
  assert(context.buffer("scan").bytes() >= gpu::Scan::scratchBytes(clusterCount + 1));
  commands.fill(starts, 0);
  commands.fill(cursors, 0);
  commands.barrier();
  commands.bind(count_, {labels, starts});
  commands.push(faceCount);
  commands.dispatchItems(faceCount, kGroup);
  scan_->scan(commands, starts, starts, clusterCount + 1, context.buffer("scan"));
  commands.bind(place_, {labels, starts, cursors, members});
  commands.push(faceCount);
  commands.dispatchItems(faceCount, kGroup);
  commands.barrier();
  commands.bind(describe_, {context.buffer("voxels"), context.buffer("faces"), starts, members, context.buffer("clusters"),
                            context.buffer(context.has("places") ? "places" : "clusters")});
  commands.push(clusterCount);
  commands.dispatchItems(clusterCount + 1, kGroup);
}

}  // namespace radivox::clustered_voxel
