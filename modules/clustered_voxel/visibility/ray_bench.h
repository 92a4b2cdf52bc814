// The rays of clustered_voxel.visibility one by one, for measuring how fast they are (`radivox bench`) and what they hit.
#pragma once

#include <string>
#include <vector>

#include "engine/gpu/timestamps.h"
#include "engine/graph/executor.h"
#include "shaders/clustered_voxel/visibility/bench.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

class RayBench {
 public:
  enum class Cast : uint32_t { Traversal, Planes, Walk };  ///< kBenchTraversal…
  struct Settings {
    uint32_t raysPerFace = 16;
    uint64_t rays = 1000000;  ///< about so many: chunks of faces, spread evenly over all
    float triangles = 2.f;    ///< voxels; Cast::Walk
    uint32_t skip = 2;        ///< kSkipClearance…; a grid too large for clearance takes kSkipBricks
    bool alphaMasked = false;
  };
  /// `executor` has run, with this visibility node's "row_start" among its outputs, and outlives this. There is a face at least.
  RayBench(gpu::Device& device, const graph::Executor& executor, const std::string& visibilityNode, const Settings& settings);

  uint64_t rayCount() const { return rayCount_; }
  const shared::Grid& grid() const { return grid_; }
  bool usesClearance() const { return settings_.skip == 2; }
  /// Lifted ones for Cast::Traversal, which would stop in the voxel that they leave; the others cast surface ones.
  std::vector<shared::BenchRay> rays(Cast cast) const;
  /// Casts all of them once; seconds on the device.
  double run(Cast cast);
  /// Of the last run: how far each ray went, in voxels; negative: it left the grid.
  std::vector<float> times() const;

 private:
  struct Chunk {
    uint32_t firstFace, rows;
    uint64_t firstRay;
  };
  gpu::Pipeline makePipeline(uint32_t task) const;
  void record(gpu::Commands& commands, const gpu::Pipeline& pipeline, const gpu::Buffer& rays) const;
  double submit(const gpu::Pipeline& pipeline, const gpu::Buffer& rays);
  void sortRows();
  void measurePieces();

  gpu::Device& device_;
  const graph::Executor& executor_;
  std::string node_;
  Settings settings_;
  shared::Grid grid_{};
  std::vector<Chunk> chunks_;
  uint64_t rayCount_ = 0;
  gpu::Buffer directions_, order_, pieces_, surfaceRays_, liftedRays_, times_;
  gpu::Pipeline casts_[3];
  gpu::DescriptorPool pool_;
  gpu::Timestamps timestamps_;
};

}  // namespace radivox::clustered_voxel
