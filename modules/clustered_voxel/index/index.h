// clustered_voxel.index — from a voxel's place to its number and back, and how far it is to the next one.
//
// reads   voxelize grid, occupancy
// writes  rank      u32 × B  occupied voxels in the bricks before
//         voxels    u32 × V  packed coordinate of each voxel, ordered by brick, then bit
//         distance  u8 × B   Chebyshev distance to the nearest occupied brick, in bricks; 0: occupied itself; at most 255. Four a word
// runs    when the voxels change
// cost    O(B) for ranks and list; the distance transform O(B · distance) a lane, three passes; 10 bytes a brick, 4 a voxel
// source  METHODS section 1, Index. One exact distance instead of two coarser levels: it lets a ray skip as far as there is nothing
#pragma once

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Index : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.index";

  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  gpu::Pipeline brickCounts_, listVoxels_, distance_;
  std::unique_ptr<gpu::Scan> scan_;
};

}  // namespace radivox::clustered_voxel
