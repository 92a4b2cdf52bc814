#include "modules/clustered_voxel/cluster/shares.h"

namespace radivox::clustered_voxel {

void Shares::declare(graph::Declaration& d) {
  d.read("clusters", "Cluster");
  d.modify("members", "face ids by cluster; then with their shares: shared/cluster_member.h");
  d.read("weights", "how much of each face others see").frees = true;
  d.hostPaced();
}

void Shares::prepare(graph::PrepareContext& context) {
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  shares_ = gpu::Pipeline(
      context.device(),
      gpu::ComputePipelineInfo{.shader = "clustered_voxel/cluster/shares.comp", .bindings = {kB, kB, kB}, .pushConstantBytes = 4});
}

void Shares::record(graph::RecordContext& context) {
  const auto clusterCount = static_cast<uint32_t>(context.count("clusters"));
  if (clusterCount == 0) return;
  gpu::Commands& commands = context.commands();
  commands.bind(shares_, {context.buffer("clusters"), context.buffer("members"), context.buffer("weights")});
  commands.push(clusterCount);
  commands.dispatchItems(clusterCount, 64);
}

}  // namespace radivox::clustered_voxel
