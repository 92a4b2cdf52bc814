// clustered_voxel.cluster — groups voxel faces that lie near each other and face the same way.
//
// reads   grid, occupancy, rank, voxels, mask, first, faces
// writes  labels  u32 × F  dense cluster id of each face, numbered in order of the cluster's lowest face
//         count   u32      clusters; publishes [clusters]
//         status  ClusterControl (read back): cells, seeds, iterations, faces changed last, orphans, pieces, merges
// runs    when the faces change
// cost    O(F) memory (27 words a face of scratch); a round tests each face against the seeds of 27 cells that face its way, and after the
//         first few only against those that moved; 3 dispatches a round, about 40 besides
// source  clustered_voxel_2022 section 4.2, algorithm 1 (its words; equation 1 has no distance in it); METHODS section 1, Cluster; SLIC
//
// Seeds: one per seed cell of spacing³ voxels and dominant direction of the normals in it, so that the two sides of a thin wall never
// meet. D² = space_weight |x_s − x_c|²/S² + normal_weight (1 − n_s·n_c)/(1 − cos angle); a seed rejects faces whose normal is farther
// than `angle` from its own. Each face decides for itself among the seeds of 27 cells, so nothing depends on timing.
// What holds at the end: every face is in one cluster; its faces are connected (26 neighbours between which no wall stands:
// shaders/clustered_voxel/cluster/apart.glsl); each face is within `angle` of the normal of one common seed, and so within 2 · angle of
// the cluster's mean. Faces that no seed accepts form clusters of their own (the paper drops them). Clusters of at most `merge` faces join a
// touching cluster whose seed accepts all of them, if there is one.
//
// Two rounds are the default: in Sponza ten give the same error (34.44 against 34.45 dB, bias 0.995 either way) for twice the time.
#pragma once

#include <memory>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"
#include "shaders/clustered_voxel/cluster/cluster_types.h"

namespace radivox::clustered_voxel {

class Cluster : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.cluster";
  static constexpr uint32_t kMergeRounds = 4;

  Cluster();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  shared::ClusterPush makePush(uint32_t faceCount, uint32_t voxelCount) const;
  void recordSeeds(graph::RecordContext& context, const shared::ClusterPush& push) const;
  void recordIterations(graph::RecordContext& context, const shared::ClusterPush& push) const;
  void recordPieces(graph::RecordContext& context, const shared::ClusterPush& push) const;
  void recordLabels(graph::RecordContext& context, const shared::ClusterPush& push) const;

  uint32_t spacing_ = 4;
  float angleDegrees_ = 35.f;
  float spaceWeight_ = 1.f;
  float normalWeight_ = 1.f;
  uint32_t iterations_ = 2;
  float stopFraction_ = 0.001f;
  uint32_t merge_ = shared::kMostMergeFaces;
  params::Table table_;
  std::unique_ptr<gpu::Scan> scan_;
  gpu::Pipeline insertCells_, flagFounders_, numberCells_, countCells_, countSeeds_, labelFaces_, sortFaces_, arguments_;
  gpu::Pipeline accumulate_, updateSeeds_, assign_, decide_;
  gpu::Pipeline startPieces_, connect_, connectOrphans_, countPieces_, choose_, mergePieces_, relabel_;
  gpu::Pipeline lowestFaces_, flagLowest_, writeLabels_;
};

}  // namespace radivox::clustered_voxel
