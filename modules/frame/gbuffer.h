// frame.gbuffer — what the camera sees at each pixel's centre.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures, view.camera
// writes  position  image RGBA32F  relative world metres, exactly on the triangle's plane; w: distance along the view axis, 0: sky
//         normal    image RGBA32F  unit shading normal on the viewer's side of the surface; w = 0
//         albedo    image RGBA32F  ρ; a: 1 surface, 0 sky
//         emission  image RGBA32F  L_e towards the viewer, W/(m² sr); 0 from behind; a = 0
//         triangle  image R32UI    id + 1; 0: sky
// runs    when the scene or the camera changes
// cost    triangles vertices + covered pixels × overdraw; 68 B a pixel, of which 4 (depth) are scratch
// source  METHODS section 0 (sides, clamped ρ). Sky pixels are 0 in every image.
#pragma once

#include "engine/graph/node.h"
#include "modules/frame/sides.h"

namespace radivox::frame {

class GBuffer : public graph::Node {
 public:
  static constexpr std::string_view kType = "frame.gbuffer";
  GBuffer();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  Sides sides_ = Sides::Both;
  params::Table table_;
  gpu::Pipeline pipeline_;
};

}  // namespace radivox::frame
