// clustered_voxel.faces — which of a voxel's six faces carry surface.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures; voxelize grid, occupancy; index rank
// writes  mask   u32 × V        bit f: a_s > 0 in fixed point (2⁻³² h²)
//         first  u32 × (V + 1)  faces before the voxel; the last one is F
//         count  u32            [faces]
// runs    when the geometry, the voxels or a parameter changes
// cost    an outline integral a (triangle, voxel) pair, and up to 36 texture look-ups where alpha masks are
// source  METHODS section 1, Voxelize (area); the paper keeps fragment lists instead
//
// Area is that of the polygon inside the half-open voxel, so a voxel that is only touched has no faces, and neither has one whose
// pieces an alpha mask takes away. Pieces that give a face less than half of 2⁻³² h² make none.
#pragma once

#include "modules/clustered_voxel/voxelize/triangle_pass.h"

namespace radivox::clustered_voxel {

class Faces : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.faces";

  Faces();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  TrianglePass::Method method_ = TrianglePass::Method::Auto;
  params::Table table_;
  TrianglePass pass_;
  gpu::Pipeline numberFaces_;
  std::unique_ptr<gpu::Scan> scan_;
};

/// Specialization constants 0…2 of material.glsl: textures, alpha masks, emission.
std::vector<gpu::SpecializationConstant> materialConstants(const scene::Traits& traits);

}  // namespace radivox::clustered_voxel
