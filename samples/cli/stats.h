// --stats: one JSON file that says what ran, how long, and what it took.
#pragma once

#include <string>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/scene/scene.h"
#include "samples/cli/job.h"

namespace radivox::cli {

struct Phases {
  double loadMs = 0;      ///< scene file to host memory
  double prepareMs = 0;   ///< device, upload, plan, pipelines
  double runMs = 0;       ///< all frames
  double downloadMs = 0;  ///< images to host memory
  double writeMs = 0;     ///< picture files
  double totalMs = 0;
};

struct RunRecord {
  Phases phases;
  std::vector<graph::FrameStats> frames;  ///< at least one
  std::vector<std::string> notes;         ///< what had to be lowered to fit
  std::string camera;
  uint32_t validationMessageCount = 0;
  bool validated = false;
};

/// Bytes of all buffers that clustered_voxel nodes own, over the number of occupied voxels; 0 without voxels. Images are left out: they
/// grow with the picture, not with the scene.
double bytesPerVoxel(const graph::FrameStats& frame, const graph::Plan& plan);

std::string printStats(const Options& options, const Job& job, const scene::Scene& scene, const gpu::Capabilities& capabilities,
                       const graph::Plan& plan, const RunRecord& record);

}  // namespace radivox::cli
