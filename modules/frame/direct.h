// frame.direct — direct irradiance on screen from punctual lights and emissive triangles.
//
// reads   gbuffer position, normal, triangle; scene.vertices, .indices, .triangle_materials, .materials, .info, .lights, .shadow_views,
//         .emissive_triangles; view.camera;
//         shadow_depth?, shadow_triangle? = shadow_map.depth, .triangle (without them nothing is shadowed);
//         grid?, occupancy?, rank?, distance?, clearance?, triangle_first?, triangle_ids?, corners? = the triangles in the voxels (rays; unwanted where no
//         indirect light is asked for, since voxels are made for that); scene.textures? (alpha masks);
//         emitted? = irradiance that emitters bring, found by rays (only where traits say emittersByRays)
// writes  irradiance  image RGBA32F  E_direct at the pixel's surface, W/m²; a: 1 surface, 0 sky. Not the sky's light: composite adds that
// runs    when the view, the lights or the shadow maps change
// cost    pixels × (punctual lights × 4 texels + emitter samples × (2·filter)² texels + emissive triangles up to `closed_form`); at shadow edges 8 × up to 40 texels a
//         light; with rays a walk through the voxels where no triangle of the four texels is in the way, and 16 at edges (Sponza, 1280×720: 0.47 s of
//         which the map takes 0.3, lavapipe on two cores). Left out without lights and emitters.
// source  KHR_lights_punctual; Lambert's boundary formula (shaders/frame/polygon.glsl); shadow.glsl for visibility
//
// With `rays` (and edges=exact) shadows of punctual lights are those of the triangles themselves: a point is lit if a ray to the light meets none,
// masks and sides obeyed. A ray that passes a voxel without a list (triangles.most) leaves its pixel to the shadow map. Edges are where
// the map, its texels beside the pixel or the ray disagree; there eight rays are the share of the pixel that is lit.
//
// Light counts only where it meets the viewer's side, by shading and by geometric normal.
// Emitters: at most `closed_form` emissive triangles are summed in closed form, times the visible share Σ w V / Σ w over the emitter
// samples, w = a sample's unshadowed irradiance: exact without occluders, and not singular near an emitter. Above that, the samples alone.
// Where emitters have no samples (emittersByRays) `emitted` is added if connected, as in the graph of the pixel receiver. Else the closed form is used unshadowed, its form
// factors normalised to at most 1: exact inside convex emitters (a furnace), too bright behind occluders; the plan and the figure
// `emitters_unshadowed` say so.
#pragma once

#include "engine/graph/node.h"
#include "modules/frame/sides.h"

namespace radivox::frame {

class Direct : public graph::Node {
 public:
  static constexpr std::string_view kType = "frame.direct";
  Direct();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  /// As kEmitters of direct.comp.
  enum class Emitters : uint32_t { None, Shadowed, Samples, Unshadowed, Image };
  Emitters chooseEmitters(const scene::Traits& traits, bool hasImage) const;

  enum class Edges : uint32_t { Exact, Filtered };
  Edges edges_ = Edges::Exact;
  bool rays_ = true;
  Sides sides_ = Sides::Both;
  uint32_t filter_ = 3;
  uint32_t closedForm_ = 256;
  params::Table table_;
  Emitters emitters_ = Emitters::None;
  bool hasRays_ = false;
  gpu::Pipeline pipeline_, clearancePipeline_;
  const gpu::Image absent_{};  ///< bound where the specialized shader reads nothing
};

}  // namespace radivox::frame
