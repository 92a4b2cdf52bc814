// Faces that a lazy node has still to work on: wanted by the view and not yet valid. Shared by gather and filter.
#pragma once

#include <memory>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class LazyFaces {
 public:
  /// Declares valid*, status (read back), and scratch todo, list, scan.
  static void declare(graph::Declaration& d);
  void prepare(gpu::Device& device);
  /// Lists the bits of `wanted` (or all faces) that valid lacks, and sets them there. `stale`: nothing that was valid is so any more. Afterwards list
  /// holds the faces, status their number, then indirect dispatch arguments for groups of 64. False: there are no faces, and status says so.
  bool record(graph::RecordContext& context, const gpu::Buffer& wanted, bool all, bool stale);

  static constexpr uint64_t kArgumentsOffset = 4;  ///< of the dispatch arguments in status, bytes

 private:
  gpu::Pipeline select_;
  std::unique_ptr<gpu::Scan> scan_;
};

}  // namespace radivox::clustered_voxel
