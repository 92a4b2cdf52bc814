// clustered_voxel.members — what each cluster holds.
//
// reads   voxels, faces, labels
// writes  clusters  Cluster × (C + 1) area-weighted mean albedo, and where the members are
//         places?   ClusterPlace × C  area-weighted means of position and normal, Σ a_s; made only if read
//         members   u32 × F           face ids by cluster, ascending within each
// runs    when the clusters change
// cost    counting sort of F words; one lane a cluster for n log n steps of sorting and n of sums
// source  clustered_voxel_2022 algorithm 1, lines 15 and 16; METHODS section 1
#pragma once

#include <memory>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Members : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.members";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  std::unique_ptr<gpu::Scan> scan_;
  gpu::Pipeline count_, place_, describe_;
};

}  // namespace radivox::clustered_voxel
