// What visibility keeps of a run (visibility.keep), so that after a move it traces only the rays that pass what has changed: shaders and layout in
// shaders/clustered_voxel/visibility/kept_hits.h.
//
// Changes are found, not told: a voxel has changed if the hash of all that rays can meet in it has, so objects may move, bend, come and go. The
// changed voxels are wrapped in a few boxes; a ray whose way from voxel to voxel stays clear of them meets what it met, for nothing else that it
// depends on has changed: its direction and random numbers follow from its face's place. So the rows are those of a run from scratch, bit for bit.
#pragma once

#include <optional>
#include <span>

#include "engine/graph/node.h"
#include "shaders/clustered_voxel/visibility/kept_hits.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

/// At most kMostChangedBoxes boxes around all voxels whose bits are set (two words a brick, as occupancy), that rays are unlikely to meet.
std::vector<shared::ChangedBox> wrapChanges(const shared::Grid& grid, std::span<const uint32_t> changed);

class KeptHits {
 public:
  static constexpr uint32_t kPushBytes = 24 + sizeof(shared::KeptHits) + 4;

  static void declare(graph::Declaration& d, uint32_t rays);
  void prepare(graph::PrepareContext& context, uint32_t rays, gpu::Pipeline reuse);

  /// Makes room for what this run keeps, and sees whether the run before left something that serves.
  void begin(graph::RecordContext& context, const shared::Grid& grid);
  /// Records what this run keeps of voxels, and compares.
  void recordVoxels(graph::RecordContext& context);
  /// The comparison's result, once it is there.
  void readChanges(graph::RecordContext& context);
  bool reuses() const { return reuses_; }
  /// Hits of a chunk that stay, and bits of the rays to trace. `trace`: bindings of the trace; `push`: its constants.
  void recordReuse(graph::RecordContext& context, std::vector<gpu::BoundResource> trace, const void* push, uint32_t rows);
  /// All hits of a chunk are there.
  void recordHits(graph::RecordContext& context, uint32_t firstFace, uint32_t rows);
  void end(graph::RecordContext& context);

 private:
  const gpu::Buffer& now(graph::RecordContext& context) const;

  uint32_t rays_ = 0;
  gpu::Pipeline voxels_, changes_, match_, reuse_;
  bool odd_ = false;                  ///< which port this run keeps in
  std::optional<shared::Grid> grid_;  ///< of the run whose hits are kept; none: there are none
  shared::KeptHits old_{}, now_{};
  shared::Grid newGrid_{};
  bool reuses_ = false;
  std::vector<shared::ChangedBox> boxes_;
};

}  // namespace radivox::clustered_voxel
