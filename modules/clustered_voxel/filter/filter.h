// clustered_voxel.filter — smooths gathered irradiance over the surface, lazily, without crossing walls.
//
// reads   shown, needed, the voxel structure, gathered irradiance, gathered_sky?, gathered_emitted?; cluster_radiosity,
//         row_start and scene.sky? only to notice that the light or the rays changed
// writes  irradiance* vec4 × F, sky* vec4 × F (only where the sky has an image), emitted* vec4 × F (only where emitters light by rays),
//         valid* bits × F, status u32 × 4 (faces filtered by this run, then dispatch arguments)
// runs    when shown faces or gathered irradiance change; filters faces that are shown and not yet valid
// cost    passes × filtered faces × (2 radius + 1)³ look-ups
// source  the paper (4.4) blurs twice with a 5³ Gaussian over same-direction faces and drops unlit ones, which adds energy in shadow;
//         weights=gaussian is that. weights=surface (default) also weighs by area, normal and plane agreement, keeps dark faces, and
//         does not look through a voxel face that stands between the two.
#pragma once

#include "engine/graph/node.h"
#include "modules/clustered_voxel/lazy_faces.h"

namespace radivox::clustered_voxel {

class Filter : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.filter";
  enum class Weights : uint32_t { Surface, Gaussian };
  Filter();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  void recordPasses(graph::RecordContext& context, const gpu::Buffer& gathered, const gpu::Buffer& filtered);

  bool hasSky_ = false;      ///< with an image
  bool hasEmitted_ = false;  ///< emitters light by rays
  uint32_t radius_ = 1;
  uint32_t passes_ = 1;
  Weights weights_ = Weights::Surface;
  params::Table table_;
  LazyFaces faces_;
  gpu::Pipeline filter_;
};

}  // namespace radivox::clustered_voxel
