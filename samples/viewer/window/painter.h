// Paints panel frames into an image, on a device of its own. One thread at a time.
#pragma once

#include "engine/gpu/commands.h"
#include "samples/viewer/window/panel_frame.h"

namespace radivox::viewer {

class Painter {
 public:
  Painter(gpu::Device& device, VkFormat format);

  /// Copies the frame to the device; waits.
  void load(const PanelFrame& frame);
  /// Draws what was loaded over all of `target`, and leaves it in layout `after`.
  void record(VkCommandBuffer commands, gpu::Image& target, VkImageLayout after);

 private:
  struct Texture {
    std::shared_ptr<const Pixels> pixels;  ///< that the buffer holds
    gpu::Buffer texels;
  };
  gpu::Device& device_;
  gpu::DescriptorPool pool_;
  gpu::Pipeline pipeline_;
  gpu::Buffer vertices_, indices_;
  std::array<Texture, kTextureCount> textures_;
  uint32_t width_ = 0, height_ = 0;
  std::vector<PanelFrame::Draw> draws_;
};

/// The frame as a picture, on a device without a window.
Pixels paintFrame(gpu::Device& device, const PanelFrame& frame);

}  // namespace radivox::viewer
