// clustered_voxel.gather — irradiance of the voxel faces that the view needs, and of no others.
//
// reads   needed; visibility row_start, entries, chunk_table; cluster_places (differential), cluster_radiosity, face_radiosity; faces, voxels; scene.sky?,
//         scene.info?; emission?, cluster_emission?
// writes  irradiance* vec4 × F  E_indirect, W/m²; a: sky visibility, the share of rays that left the scene; meaningful where valid
//         sky*        vec4 × F  E_sky, W/m², only where the sky has an image; elsewhere it is π L × sky visibility
//         emitted*    vec4 × F  irradiance straight from emitters, W/m², only where these light by rays (Traits::emittersByRays): Σ (m/M) B_e
//         valid*      bits × F  the face has been gathered under the present light
//         error*      vec3 × F  standard error of E_indirect, W/m², from the spread of its M rays as if they were independent: they are stratified,
//                               so sampling errs less; what voxels and clusters leave out is not in it. Made only if read; counted only
//         status      u32 × 2   faces gathered by this run
// runs    when the needed set, the light or the visibility changes; gathers faces that are needed and not yet valid
// cost    Σ row lengths of the gathered faces
// source  METHODS section 1, Gather. estimator=counted: E_s = Σ (m/M) B, rows sum to 1, a furnace is exact.
//         estimator=differential: the paper's (4.4) Σ B_c A_c cosθ cosθ' / (π d²) over distinct visible clusters.
#pragma once

#include "engine/graph/node.h"
#include "modules/clustered_voxel/lazy_faces.h"

namespace radivox::clustered_voxel {

class Gather : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.gather";
  enum class Estimator : uint32_t { Counted, Differential };
  Gather();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  Estimator estimator_ = Estimator::Counted;
  bool lazy_ = true, hasSky_ = false, hasEmitted_ = false;
  params::Table table_;
  LazyFaces faces_;
  gpu::Pipeline gather_;
};

}  // namespace radivox::clustered_voxel
