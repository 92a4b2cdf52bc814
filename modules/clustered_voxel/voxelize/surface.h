// clustered_voxel.surface — what each voxel face is: area, albedo, mean normal, mean position, emission.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures; voxelize grid, occupancy; index rank, voxels;
//         faces mask, first; triangles first?, ids? (which pieces are no part of which faces; absent: all are part of all)
// writes  faces     Face × F   a_s = Σ w in h², w = area · |n·e_f| (faces=dominant: area or 0); ρ_s, n_s, x_s: means weighted by w; margins: how far from
//                             the voxel's sides it ends, seen along e_f
//         emission  vec3 × F   B_e = π Σ w L_e / a_s, W/m², of what faces outward on this side; 0: dark. Made only if read
// runs    when the geometry, materials, the voxels or a parameter changes
// cost    an outline integral and up to 62 atomic adds a (triangle, voxel) pair, twice that for double-sided materials; scratch 84 bytes a face (108 with
//         emitters) and 8 a voxel
// source  METHODS section 1, Voxelize; normals=heuristic: clustered_voxel_2022 section 4.2
//
// A face is made of the surface that shows its front there. Where sides=both, a face that sees backs alone is made of those; backs that share a
// face with fronts do not count: the two skins of a thin wall often share voxels, and what each shows inside the wall, where no light comes,
// would halve the other's radiosity.
//
// Sums are 64-bit fixed point, so their order does not matter. n_s is the shading normal, turned to the geometric normal's side;
// where the normals of a face cancel it is e_f. figure total_area: Σ area of triangle ∩ voxel, m², to hold against the mesh's.
#pragma once

#include "modules/clustered_voxel/voxelize/triangle_pass.h"

namespace radivox::clustered_voxel {

class Surface : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.surface";
  enum class Normals : uint32_t { Mean, Heuristic };

  Surface();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  void sumPieces(graph::RecordContext& context);
  void resolveFaces(graph::RecordContext& context);

  TrianglePass::Method method_ = TrianglePass::Method::Auto;
  Normals normals_ = Normals::Mean;
  bool emissive_ = false;       ///< some material emits
  bool wantsEmission_ = false;  ///< and somebody reads it
  params::Table table_;
  TrianglePass pass_;
  gpu::Pipeline emissionPeak_, resolve_;
};

}  // namespace radivox::clustered_voxel
