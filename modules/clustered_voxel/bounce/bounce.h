// clustered_voxel.bounce — light that surfaces pass on among themselves.
//
// reads   row_start, entries of transfer (not needed for one bounce without emitters by rays); clusters, members, faces; labels,
//         visibility_row_start, visibility_entries, chunk_table (last=faces; optional): rows of visibility
//         face_irradiance and direct_radiosity of inject; emission where emitters light through rays (Traits::emittersByRays)
// writes  cluster_radiosity  vec3 × C  reflected B, W/m², without emission; 0: black or unlit
//         face_radiosity     vec3 × F  likewise: ρ_s (E_dir,s + E_emit + E_ind), direct light at the detail of faces
//         cluster_emission   vec3 × C  mean B_e, W/m²; made where emitters light through rays
//         status             u32 × 4   (read back) iterations; residual as float bits; 1: fell back to plain steps; why it ended
// runs    when the light, the matrix or the clusters change
// cost    an iteration is a pass over the matrix (4 B an entry); recorded `iterations` times, those after the end dispatch nothing;
//         last=faces: a pass over the rows (about 14 bits an entry), which stay in memory for it
// source  METHODS section 1, Bounce: B = B⁰ + ρFB per colour channel, B⁰ = Σ a ρ E_dir / Σ a; beyond the paper, which stops at one bounce
//
// request.bounces = n: n − 1 plain steps, so that eyes see n bounces. kAllBounces: until |B⁰ + ρFB − B| ≤ residual · max B⁰ or, where that
// is out of float's reach (ρ near 1), 2⁻²³ max B; the error is at most the residual / (1 − r), r the spectral radius of ρF. The solver
// starts below every solution, at −max B⁰: then its first residual is positive, eight plain steps keep it so, and the greatest ratio of two
// successive residuals bounds r from above (Collatz, Wielandt), much closer than max ρ does. Chebyshev iteration for eigenvalues in [−r, r]
// takes it from there, in about ln(1/residual) / √(2(1 − r)) steps, and where a lit cluster's own residual is then above 10⁻³ of itself (it
// lies beside a far brighter light) plain steps go on until it is not; if its residual does not fall over 16 steps, plain steps follow, which
// contract in every case since rows of F sum to at most 1 and ρ < 1.
//
// last=faces (auto: under a sky, since its light keeps the rows in memory anyway), where rows are connected: each face receives the last bounce by
// its own rays, from the solved clusters; hits near it count with the direct light of the very face. A cluster's mean knows neither which of its
// faces lie in the open nor which are seen: without this, every bounce loses some two parts in a hundred in Sponza.
#pragma once

#include "engine/graph/node.h"
#include "shaders/clustered_voxel/bounce/bounce_types.h"

namespace radivox::clustered_voxel {

class Bounce : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.bounce";
  enum class Solver : uint32_t { Chebyshev, Plain };
  enum class Last : uint32_t { Faces, Clusters, Auto };

  Bounce();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  void recordEmission(graph::RecordContext& context, const shared::BouncePush& push) const;
  void recordClusters(graph::RecordContext& context, const shared::BouncePush& push) const;
  /// The last bounce to each face: by its own rays, or as its cluster received it.
  void recordFaces(graph::RecordContext& context, shared::BouncePush push, uint32_t sweeps) const;
  void recordMembers(graph::RecordContext& context, const shared::BouncePush& push) const;
  void recordSweeps(graph::RecordContext& context, const shared::BouncePush& push, uint32_t count) const;
  shared::BounceControl makeControl(uint32_t clusterCount, bool counted) const;

  Solver solver_ = Solver::Chebyshev;
  Last last_ = Last::Faces;
  float residual_ = 1e-6f;
  uint32_t iterations_ = 1000;
  bool hasRows_ = false;
  params::Table table_;
  gpu::Pipeline meanEmission_, receiveEmission_, source_, begin_, sweep_, receive_, finishClusters_, finishFaces_;
};

}  // namespace radivox::clustered_voxel
