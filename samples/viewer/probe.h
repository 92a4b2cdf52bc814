// What one voxel face sees: its visibility row as the graph keeps it, and its rays traced again for the eye.
#pragma once

#include "engine/gpu/commands.h"
#include "samples/viewer/picture.h"
#include "samples/viewer/ports.h"
#include "shaders/shared/voxel.h"

namespace radivox::viewer {

class FaceProbe {
 public:
  explicit FaceProbe(gpu::Device& device) : device_(device), pool_(device) {}
  /// Needs a plan for which OverlayPainter::findFault(VisibleClusters) is empty. `face` < count of faces.
  PointedFace read(const Ports& ports, uint32_t face);

 private:
  void readRow(const Ports& ports, PointedFace& pointed);
  static bool isRetraceable(const Ports& ports);
  void traceRays(const Ports& ports, PointedFace& pointed);
  void pointToClusters(const Ports& ports, PointedFace& pointed);
  gpu::Device& device_;
  gpu::DescriptorPool pool_;
  gpu::Pipeline pipeline_;
  std::string pipelineKey_;  ///< parameters that the pipeline and the directions were made for
  gpu::Buffer directions_, ends_;
  shared::Grid grid_{};
  uint32_t rayCount_ = 0;
};

}  // namespace radivox::viewer
