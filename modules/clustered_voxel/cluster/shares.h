// clustered_voxel.shares — how much each member counts in its cluster's means.
//
// reads   clusters of members; weights of visibility, which it frees where nobody reads them later
// changes members  u32 × F  face | share << 24: its weight over the largest of the cluster in steps of 1/255; 0 throughout where nobody sees
//                           any face of the cluster (means then go by area)
// runs    when the clusters or what faces see change; host-paced, since it frees
// cost    two passes over the members
// source  beyond the paper, which weighs by area: what lies buried in other surface sends nothing to anybody. 8 bits stand beside the face's
//         number, and save the 4 B a face of the weights
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Shares : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.shares";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  gpu::Pipeline shares_;
};

}  // namespace radivox::clustered_voxel
