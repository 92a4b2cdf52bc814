// clustered_voxel.voxelize — which voxels the surfaces touch.
//
// reads   scene.vertices, scene.indices
// writes  grid       Grid        [bricks]
//         occupancy  uvec2 × B   a bit a voxel: 1 where a triangle overlaps its closed cube
//         count      u32 × 4     [voxels], 0, 0, 0
// runs    when the geometry or a parameter changes
// cost    a separating-axis test a (triangle, voxel) pair in the triangles' planes; 8 bytes a brick of 64 voxels, dense
// source  clustered_voxel_2022 section 4.1; METHODS section 1, Voxelize
//
// Grid also says to which of a voxel's faces surface belongs (faces; shared/face_shares.h): projected, the paper's, gives each of up to three faces its
// |n·e_f| of the area; dominant gives all to the face that it looks along the most. Six tenths of the faces then hold the same surface in Sponza, each
// a ray's start in its own right, and the two sides of an edge seldom share one. Rays tell surface as well from them; interpolation over faces does
// not (graph clustered_voxel: 25.0 instead of 27.7 dB), so it is what graphs whose pixels gather ask for.
//
// The cubes are dilated by 2e-5 voxel edges, which covers all rounding: every voxel that the exact test finds is there, and none that
// the exact test of cubes dilated by 4e-5 does not find. The same bits whatever the method and the device.
#pragma once

#include "modules/clustered_voxel/voxelize/grid.h"
#include "modules/clustered_voxel/voxelize/triangle_pass.h"

namespace radivox::clustered_voxel {

class Voxelize : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.voxelize";
  enum class Sides : uint32_t { Both, Gltf };
  enum class Faces : uint32_t { Projected, Dominant };

  Voxelize();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  std::string adviseResolution(const scene::Traits& traits) const;

  uint32_t resolution_ = 128;
  Sides sides_ = Sides::Both;
  Faces faces_ = Faces::Projected;
  TrianglePass::Method method_ = TrianglePass::Method::Auto;
  params::Table table_;
  shared::Grid grid_{};
  TrianglePass pass_;
  gpu::Pipeline countVoxels_;
};

}  // namespace radivox::clustered_voxel
