// clustered_voxel.gather_pixels — indirect irradiance on screen, gathered by voxel rays from the pixels themselves.
//
// reads   gbuffer position, normal; the voxel structure and distance; planes, plane_extras, clearance? of visibility; face_radiosity
// writes  irradiance image RGBA32F  E_indirect at the pixel's surface, W/m²; a: sky visibility; 0 on the sky
// runs    when the view, the voxels or the radiosity change
// cost    pixels × rays grid walks, then one pass of 25 reads a pixel (and 25 more a `smooth` pass)
// source  beyond the paper (METHODS section 1, "The receiver is where the error sits"): irradiance interpolated over voxels loses
//         near-field light and shadow. Here neighbouring pixels trace different parts of one low-discrepancy set: any 4×4 block of pixels
//         holds 16 × rays directions, and a filter over such blocks, which stops at edges of the surface, puts them together.
//
// Rays stop where those of visibility do (shaders/shared/voxel_cast.glsl): at the mean planes of the surface in voxels, so that the receiver's
// own surface never shades itself, and contact shadows are finer than the voxels.
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class GatherPixels : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.gather_pixels";
  GatherPixels();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  uint32_t rays_ = 16;
  uint32_t smooth_ = 1;
  float near_ = 2.f;
  bool shadow_ = true;
  bool hasTriangles_ = false, isMasked_ = false, hasShadow_ = false;
  params::Table table_;
  const gpu::Image absent_;  ///< bound where the specialized shader reads nothing
  gpu::Buffer directions_;
  gpu::Pipeline trace_, traceBricks_, filter_;
};

/// The first points of the (0,2)-sequence of Sobol: any aligned power-of-two run is well spread over the unit square.
std::vector<glm::vec2> sobolPoints(uint32_t count);

}  // namespace radivox::clustered_voxel
