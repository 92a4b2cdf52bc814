// clustered_voxel.mark — which voxel faces this view needs, exactly.
//
// reads   gbuffer position, normal; grid, occupancy, rank, mask, first, faces
// writes  shown  bits × F  the face is in the shading stencil of some pixel
//         needed bits × F  shown, or within the filter's reach of a shown face
// runs    when the G-buffer or the voxels change
// cost    one lane a pixel, up to 24 look-ups; one lane a shown face and (2r+1)³ look-ups for the reach
// source  METHODS section 1, Mark; the paper (4.4) tests 12 points about every voxel of the scene against a depth map instead
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Mark : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.mark";
  Mark();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  uint32_t reach_ = 2;
  params::Table table_;
  gpu::Pipeline mark_, reachPipeline_, countBits_;
};

}  // namespace radivox::clustered_voxel
