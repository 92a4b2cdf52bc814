// Overlays: the voxel faces that pixels show, coloured by what they are or hold.
#pragma once

#include <map>

#include "engine/gpu/commands.h"
#include "samples/viewer/picture.h"
#include "samples/viewer/ports.h"

namespace radivox::viewer {

class OverlayPainter {
 public:
  explicit OverlayPainter(gpu::Device& device);

  /// Why this plan cannot show the overlay; empty: it can.
  static std::string findFault(const Ports& ports, Overlay overlay);

  /// Finds the face of every pixel, on surfaces or (blocks) on voxels cast from `camera`; needed before the two below.
  void findFaces(const Ports& ports, const scene::CameraDescription& camera, uint32_t width, uint32_t height, bool blocks);
  /// Id of the face at a pixel; nothing where there is none.
  std::optional<uint32_t> faceAt(const glm::uvec2& pixel);
  /// `exposure` as the picture's; `pointed` is drawn bright, and for Overlay::VisibleClusters says what to mark.
  Pixels paint(const Ports& ports, Overlay overlay, float exposure, const PointedFace* pointed);

 private:
  void submit(const std::function<void(gpu::Commands&)>& record);
  void setMarks(const PointedFace* pointed, uint64_t clusterCount, uint64_t faceCount);
  gpu::Device& device_;
  gpu::DescriptorPool pool_;
  gpu::Pipeline surface_, cast_, paint_;
  gpu::Buffer camera_, pixels_, texels_, marks_;
  std::vector<size_t> marked_;  ///< entries of marks_ that are not 0
  uint32_t width_ = 0, height_ = 0;
  bool blocks_ = false;
};

}  // namespace radivox::viewer
