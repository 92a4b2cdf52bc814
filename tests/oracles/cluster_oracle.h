// Clusters, form factors between clusters and their solution on the CPU, one thing after the other, from the definitions in
// modules/clustered_voxel/cluster/cluster.h, visibility/transfer.h and bounce/bounce.h.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/oracles/voxel_structures.h"

namespace radivox::oracle {

struct ClusterSettings {
  uint32_t spacing = 4;
  float angleDegrees = 35.f;
  float spaceWeight = 1.f;
  float normalWeight = 1.f;
  uint32_t iterations = 10;
  float stopFraction = 0.001f;
  uint32_t merge = 3;
};

struct ClusterResult {
  std::vector<uint32_t> labels;  ///< dense, in order of the clusters' lowest faces
  uint32_t clusterCount = 0;
  uint32_t seedCount = 0;
  uint32_t iterations = 0;
  uint32_t orphanCount = 0;
  uint32_t pieceCount = 0;
  uint32_t mergedCount = 0;
};

/// SLIC, founding, splitting and merging. Same labels as the node, face for face: both round every float operation once.
ClusterResult clusterFaces(const VoxelStructures& structures, const ClusterSettings& settings);

/// Empty when `labels` is a partition of the faces into connected clusters (26 neighbours), numbered densely in order of their lowest
/// face, each face within twice the angle of its cluster's area-weighted mean normal; else what is wrong.
std::string checkClusters(const VoxelStructures& structures, const std::vector<uint32_t>& labels, uint32_t clusterCount,
                          float angleDegrees);

struct ClusterDescriptions {
  std::vector<shared::Cluster> clusters;
  std::vector<shared::ClusterPlace> places;
};
ClusterDescriptions describeClusters(const VoxelStructures& structures, const std::vector<uint32_t>& labels, uint32_t clusterCount);
/// Face ids by cluster, ascending within each.
std::vector<uint32_t> listMembers(const std::vector<uint32_t>& labels, uint32_t clusterCount);

/// Rows of the faces as (entry id, count), before packing.
using VisibilityRows = std::vector<std::vector<std::pair<uint32_t, uint32_t>>>;
struct PackedRows {
  std::vector<uint32_t> rowStart;             ///< chunks · (kRowsPerChunk + 1)
  std::vector<std::vector<uint32_t>> chunks;  ///< bits of the entries
};
/// Rows by ascending id; idCount = C + F.
PackedRows packRows(const VisibilityRows& rows, uint32_t idCount);

struct SparseMatrix {
  std::vector<std::map<uint32_t, double>> rows;
  std::vector<double> sky;
};
SparseMatrix clusterTransfer(const VisibilityRows& rows, const std::vector<shared::Face>& faces, const std::vector<uint32_t>& labels,
                             uint32_t clusterCount);

/// Solution of x = b + ρFx for one channel by Gaussian elimination.
std::vector<double> solveRadiosity(const SparseMatrix& matrix, const std::vector<double>& albedo, const std::vector<double>& source);

}  // namespace radivox::oracle
