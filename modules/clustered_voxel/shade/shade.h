// clustered_voxel.shade — indirect irradiance on screen, from voxel faces.
//
// reads   gbuffer position, normal; the voxel structure; filtered irradiance, valid; filtered_sky?, filtered_emitted?
// writes  irradiance image RGBA32F  E_indirect at the pixel's surface, W/m²; a: sky visibility; 0 on the sky
//         sky?       image RGBA32F  E_sky at the pixel's surface, W/m², where the sky has an image; elsewhere π L × sky visibility is that
//         emitted?   image RGBA32F  irradiance straight from emitters, W/m², where these light by rays (Traits::emittersByRays); for direct.emitted
// runs    when the view or the irradiance changes
// cost    one lane a pixel, up to 24 look-ups
// source  METHODS section 1, Shade: E(x,n) = Σ_k n_k² E_{sign(n_k) e_k}(x), each term trilinear over the valid faces on the surface's
//         side, renormalised. interpolation=nearest is the paper's fifth row of figure 12: the pixel's own voxel face alone.
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Shade : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.shade";
  enum class Interpolation : uint32_t { Trilinear, Nearest };
  Shade();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  Interpolation interpolation_ = Interpolation::Trilinear;
  bool wantsError_ = false;  ///< AOV error
  bool hasSky_ = false;      ///< with an image
  bool hasEmitted_ = false;  ///< emitters light by rays
  params::Table table_;
  gpu::Pipeline shade_;
};

}  // namespace radivox::clustered_voxel
