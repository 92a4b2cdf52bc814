// clustered_voxel.visibility alone, over voxel structures made on the CPU: for tests.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/oracles/node_harness.h"
#include "tests/oracles/traversal_oracle.h"

namespace radivox::oracle {

using Row = std::map<uint32_t, uint32_t>;  // id → count

/// Clusters for tests: faces in runs of `size`.
std::vector<uint32_t> runLabels(size_t faceCount, uint32_t size);

class VisibilityRun {
 public:
  VisibilityRun(gpu::Device& device, const VoxelStructures& structures, const VisibilitySettings& settings,
                std::vector<uint32_t> faceLabels, const std::string& skip = "clearance");
  /// Runs the node (again) and takes its rows apart; checks that no id comes twice in a row.
  std::vector<Row> rows();
  /// All words that the node wrote, but addresses.
  std::vector<uint32_t> rawOutput();

  const std::vector<uint32_t> labels;
  const uint32_t clusterCount;
  oracles::NodeHarness harness;

 private:
  size_t faceCount_;
};

/// Fails the running test unless both are equal; shows the first difference.
void expectSameRows(const std::vector<Row>& actual, const std::vector<Row>& expected);
/// Σ counts = rays in every row.
void expectWholeRows(const std::vector<Row>& rows, uint32_t rays);

/// Rows of the node, after a check that they are the oracle's.
std::vector<Row> checkRows(gpu::Device& device, const VoxelStructures& structures, const VisibilitySettings& settings,
                           const std::string& skip = "clearance");

/// A room open to the front with a box and a turned block in it.
Soup roomSoup();
/// Small triangles all about the unit cube, half of them one-sided.
Soup randomSoup(uint32_t seed, uint32_t triangles);
/// A latitude–longitude sphere.
void addSphere(Soup& soup, const glm::vec3& center, float radius, uint32_t rings);

}  // namespace radivox::oracle
