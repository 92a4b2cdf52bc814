// clustered_voxel.inject — direct light arrives at voxel faces.
//
// reads   scene.lights, scene.shadow_views, scene.info, scene.vertices, scene.indices; shadow.depth, shadow.triangle (absent when no light
//         casts from a point: then only the sky lights faces); grid, occupancy, rank, voxels, first, faces; planes of visibility, or
//         else mask (splat: which faces a voxel has); clusters, members with shares; triangles first?, ids? (which faces a piece is no part of);
//         sky_irradiance? = sky.irradiance (where the scene has a sky)
// writes  face_irradiance   vec3 × F   E_dir, W/m², with the sky's light; 0: unlit
//         cluster_radiosity vec3 × C   Σ w ρ E_dir / Σ w, W/m²: the light that clusters send back at once
//         status            u32 × 4    texels that found no face (their flux is lost), low and high word of all lit texels, 0
// runs    when lights, shadow maps, faces or clusters change
// cost    splat: one lane 16 shadow texels, 3 to 9 additions for those of them that land in one voxel; points: 18 shadow look-ups a face and light
// source  clustered_voxel_2022 section 4.4 (points); METHODS section 1, Inject (splat)
//
// method=splat: the flux of each shadow-map texel falls into the voxel faces of the surface it lands on, so energy is kept exactly
// whatever the resolution: a texel that carries flux Φ lands on area dA with E dA = Φ, and so brings Φ max(0, n·e_f) to face f's
// Σ area·max(0, n·e_f)·E, whatever the angle. Sums are 64-bit fixed point scaled to the lights' total flux: no order matters, nothing
// wraps. Low words lie where the irradiance will be and high words where bounce will write, so sums cost no memory of their own.
// method=points: the paper's 18 points 1.5 voxels about the voxel's centre, against the shadow map, with its neighbour test.
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Inject : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.inject";
  enum class Method : uint32_t { Splat, Points };

  Inject();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  Method method_ = Method::Splat;
  params::Table table_;
  bool lit_ = false, hasSky_ = false;
  gpu::Pipeline splat_, points_, resolve_, addSky_, clusters_;
};

}  // namespace radivox::clustered_voxel
