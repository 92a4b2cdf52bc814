// clustered_voxel.inspect — which voxel face and which cluster each pixel shows: for debugging and for pictures.
//
// reads   gbuffer position, normal; the voxel structure; cluster labels
// writes  face?    image RGBA32F  face id + 1 (0: none), voxel index, face direction 0…5, area in h²
//         cluster? image RGBA32F  a colour per cluster (RGB), cluster id + 1 (0: none)
// runs    when the view, the voxels or the clusters change, and only if somebody asks for one of its images
// cost    one lane a pixel, 1 to 3 look-ups
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Inspect : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.inspect";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  gpu::Pipeline face_, cluster_;
};

}  // namespace radivox::clustered_voxel
