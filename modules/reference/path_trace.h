// reference.path_trace — the truth on screen: radiance and its parts by path tracing on the host, with the variance of each mean.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials, .textures, .info, .lights; view.camera
// writes  color                image RGBA32F  radiance, W/(m² sr), mean over the pixel's box; the sky where nothing is
//         direct, indirect     images RGBA32F reflected radiance ρE/π of each
//         irradiance_direct    image RGBA32F  E straight from lights, emitters and sky, W/m²; 0 where nothing is
//         irradiance           image RGBA32F  E after 1 … bounces reflections (the port that methods share); a = 0, since the sky's light is in
//                              irradiance_direct
//         albedo               image RGBA32F  ρ
//         color_variance, irradiance_variance  images RGBA32F  variance of the means above; 0 where a single pass leaves it unknown
//         texels               growable: level 0 of each texture, on its way to the host
//         (images have a = 1 unless said otherwise; each is made only when somebody reads it)
// runs    when the scene, the lights, the view or a parameter changes; host-paced, one step a pass
// cost    spp · pixels · (2 rays a reflection); about 300 B a triangle, 360 B a pixel on the host while it runs
// source  modules/reference/README.md
#pragma once

#include <optional>

#include "engine/graph/node.h"
#include "modules/reference/path_tracer.h"

namespace radivox::reference {

class PathTrace : public graph::Node {
 public:
  static constexpr std::string_view kType = "reference.path_trace";
  PathTrace();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  uint32_t stepCount(graph::RecordContext& context) override;
  void record(graph::RecordContext& context) override;
  void stepDone(graph::RecordContext& context) override;

 private:
  enum class Phase { CopyTexels, Trace, Write, Done };

  bool sceneChanged(graph::RecordContext& context) const;
  void readInputs(graph::RecordContext& context);
  void takeTexels(graph::RecordContext& context);
  void startRendering(graph::RecordContext& context);
  void tracePass(graph::RecordContext& context);
  void stageResults(graph::RecordContext& context);

  Sides sides_ = Sides::Both;
  uint32_t spp_ = 64;
  uint32_t seed_ = 0;
  float targetError_ = 0.f;
  float timeLimit_ = 0.f;
  params::Table table_;

  gpu::Device* device_ = nullptr;
  gpu::Pipeline copyTexels_, toImage_;
  Phase phase_ = Phase::Done;
  scene::Scene scene_;  ///< between reading and building
  scene::CameraDescription camera_;
  uint32_t width_ = 0, height_ = 0;
  std::optional<PathTracer> tracer_;
  std::optional<Rendering> rendering_;
  struct Staged {
    std::string port;
    gpu::Buffer pixels;
  };
  std::vector<Staged> staged_;  ///< results on their way to images
};

}  // namespace radivox::reference
