// clustered_voxel.gather_pixels — indirect irradiance on screen, gathered by rays from the pixels themselves.
//
// reads   gbuffer position, normal, triangle; the voxel structure and distance; planes, plane_extras, clearance? of visibility; face_radiosity;
//         triangle_first, triangle_ids, corners? of triangles and scene geometry (near > 0); shadow_depth, shadow_triangle, face_irradiance, scene.lights,
//         .shadow_views (shadow=on, where no surface emits); sky_irradiance (and there is a sky); emission of surface (emitters by rays)
// writes  irradiance image RGBA32F  E_indirect at the pixel's surface, W/m²; a: sky visibility; 0 on the sky
//         sky?       image RGBA32F  E_sky at the pixel's surface, W/m², where the sky has an image: each ray that leaves the scene sees the mean of
//                                   the image about it (scene.sky, scene.info); elsewhere π L × sky visibility is that
//         emitted?   image RGBA32F  irradiance that emitters bring straight, W/m², where they light by rays (Traits::emittersByRays): each
//                                   ray that ends on a face brings its B_e. For direct.emitted, which else has them without shadows
//         hits?      buffer uvec2 × pixels × rays  with `keep`: face and triangle of each ray; while only light changes none is traced again
// runs    when the view, the voxels or the radiosity change
// cost    pixels × rays grid walks, the first voxels of each against the triangles in them; one pass of 25 reads a pixel (and 9 more a `smooth` pass)
// source  beyond the paper (METHODS section 1, "The receiver is where the error sits"): irradiance interpolated over voxels loses
//         near-field light and shadow. Here neighbouring pixels trace different parts of one low-discrepancy set: any 4×4 block of pixels
//         holds 16 × rays directions, and a filter over such blocks, which stops at edges of the surface, puts them together. `smooth` more passes
//         average over wider neighbourhoods what differs by no more than noise, whose variance the rays tell (Dammertz et al. 2010, "Edge-Avoiding
//         À-Trous Wavelet Transform"; variance after Schied et al. 2017, "Spatiotemporal Variance-Guided Filtering", in one frame).
//
// Up to `near` voxels rays meet triangles, and what they hit there is lit as its shadow-map texel says, not as its voxel is on average: contact
// shadows and the rims of sunlit patches are as sharp as the geometry. Beyond, rays stop where those of visibility do (shaders/shared/voxel_cast.glsl).
// Sponza, N = 128, indirect: near = 0 28.8 dB, 1 32.0, 2 32.1, all 31.9; with shadow 33.8; with a shift of the directions for each block 34.6.
// Four pixels of 12 rays for one of 48 (supersampling) cost the same and are better: 37.3 dB instead of 36.7, the picture 43.7 instead of 40.3.
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
  uint32_t rays_ = 48;
  uint32_t smooth_ = 3;
  float near_ = 2.f;
  bool shadow_ = true;
  bool keep_ = false;
  bool hasTriangles_ = false, isMasked_ = false, hasShadow_ = false;
  bool hasSky_ = false;            ///< with an image
  bool hasEvenSky_ = false;        ///< without
  bool hasEmitted_ = false;        ///< emitters light by rays
  std::vector<std::string> ways_;  ///< inputs that rays' ways depend on
  bool waysChanged(graph::RecordContext& context) const;
  void filter(graph::RecordContext& context, const std::string& suffix, const char* out);

  params::Table table_;
  const gpu::Image absent_;  ///< bound where the specialized shader reads nothing
  gpu::Buffer directions_;
  gpu::Pipeline trace_, traceBricks_, light_, filter_, lightFilter_;
};

/// The first points of the (0,2)-sequence of Sobol: any aligned power-of-two run is well spread over the unit square.
std::vector<glm::vec2> sobolPoints(uint32_t count);

}  // namespace radivox::clustered_voxel
