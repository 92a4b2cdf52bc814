// clustered_voxel.fragments — how many triangles meet in a voxel, and their mean normal: for inspection.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures; voxelize grid, occupancy; index rank
// writes  count    u32 × V   triangles that overlap the voxel's closed cube, as voxelize tests it: at least 1
//         normal?  vec3 × V  unit mean of the shading normals, by area inside the half-open voxel; 0: no area, or the normals cancel
// runs    when the geometry, materials, the voxels or a parameter changes, and only if somebody reads what it writes
// cost    an atomic a (triangle, voxel) pair; with normals an outline integral and eight more; scratch 32 bytes a voxel
// source  the fragments of clustered_voxel_2022 section 4.1, counted instead of listed
#pragma once

#include "modules/clustered_voxel/voxelize/triangle_pass.h"

namespace radivox::clustered_voxel {

class Fragments : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.fragments";

  Fragments();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  TrianglePass::Method method_ = TrianglePass::Method::Auto;
  bool wantsNormals_ = false;
  params::Table table_;
  TrianglePass pass_;
  gpu::Pipeline resolve_;
};

}  // namespace radivox::clustered_voxel
