// frame.composite — radiance on screen: L = ρ (E_direct + E_indirect) / π + L_e.
//
// reads   gbuffer albedo, emission; irradiance? = direct.irradiance; indirect? = any method's irradiance image (a: sky visibility);
//         scene.info; sky? = the same method's sky image, scene.sky?, view.camera? (where the sky has an image)
// writes  color              image RGBA32F  radiance towards the viewer, W/(m² sr); sky pixels: the sky's; a: 1 surface, 0 sky
//         direct?            image RGBA32F  ρ E_direct / π, with the sky's light
//         indirect_radiance? image RGBA32F  ρ E_indirect / π
//         irradiance_direct? image RGBA32F  E_direct with the sky's light, W/m²
// runs    when an input changes
// cost    one lane a pixel; 16 B a pixel and image
// source  METHODS section 0
//
// Sky light, π L_sky × sky visibility, is direct light: it comes with the indirect image's alpha, or, where the sky has an image, in an image of
// its own (E_sky, the constant part included). The background is the image, bilinear, suns and all. With 0 bounces and no sky that image is
// unwanted, and whatever computes it is culled; with 0 bounces and a sky only its alpha counts.
#pragma once

#include "engine/graph/node.h"

namespace radivox::frame {

class Composite : public graph::Node {
 public:
  static constexpr std::string_view kType = "frame.composite";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  bool hasBackground_ = false;  ///< the sky's image
  gpu::Pipeline pipeline_;
  const gpu::Image absent_{};  ///< bound where the specialized shader touches nothing
};

}  // namespace radivox::frame
