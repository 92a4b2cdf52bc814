// clustered_voxel.sky — light of the sky on voxel faces.
//
// reads   row_start, entries, chunk_table of visibility; scene.info; scene.sky? (the image's means over the rows' bins of directions)
// writes  irradiance vec3 × F  E_sky = Σ (m/M) π L over the rays that left the scene, W/m²; at most π times the sky's brightest
// runs    when the visibility or the lights change: another sky traces no ray
// cost    Σ row lengths
// source  METHODS section 1, Face visibility: misses are kept for this
//
// inject adds it to what lamps and emitters bring: sky light is direct light, and from there on bounces as all light does. Pixels
// count the sky that they see themselves (gather_pixels, shade).
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Sky : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.sky";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;

 private:
  params::Table table_;
  gpu::Pipeline pipeline_;
};

/// Declares a read of the sky's light on faces, which is unwanted where the sky lights nothing that is passed on.
graph::Port& readSky(graph::Declaration& d);
/// Declares a read that is unwanted where the sky has no image; readSkyImage: of scene.sky.
void readUnderImage(graph::Declaration& d, const char* name, const char* meaning);
void readSkyImage(graph::Declaration& d);

}  // namespace radivox::clustered_voxel
