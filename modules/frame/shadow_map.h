// frame.shadow_map — what every light sees: depth and triangle of the nearest surface.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures, .shadow_views (host visible: tiles are read while
// recording) writes  depth     image D32F array    reversed z of the true surface in its view, no bias; 0: nothing there
//         triangle  image R32UI array   id + 1 of that surface; 0: nothing there
// runs    when the scene or its lights change
// cost    views × triangles vertices, covered texels; memory 8 B × shadow_resolution² × shadow_layers. Left out without shadow views.
// source  shadow mapping (Williams 1978); ids beside depth so that a receiver knows itself (shaders/frame/shadow.glsl)
//
// A view is a tile of a layer (shared::ShadowView); a layer is one rendering, its views are draws with the tile as viewport.
#pragma once

#include "engine/graph/node.h"
#include "modules/frame/sides.h"

namespace radivox::frame {

class ShadowMap : public graph::Node {
 public:
  static constexpr std::string_view kType = "frame.shadow_map";
  ShadowMap();
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
