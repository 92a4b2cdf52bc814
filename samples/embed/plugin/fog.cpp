// sample.fog: air that scatters, evenly lit.
//
// reads   color     image RGBA32F  radiance, W/(m² sr)
//         position  image RGBA32F  relative world m; w: distance along the view axis, 0: sky
// writes  color_in_fog  image RGBA32F  color · e^(−density · w) + radiance · (1 − e^(−density · w)); the sky stays
// runs    when the picture, the view or a parameter changes
// cost    one lane a pixel; 16 B a pixel
// source  Beer and Lambert
#ifndef __cplusplus  // the shader; the build takes it from here, and the rest from below

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) readonly uniform image2D colorImage;
layout(set = 0, binding = 1, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 2, rgba32f) writeonly uniform image2D foggyImage;
layout(push_constant) uniform Push { float density, radiance; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(foggyImage)))) return;
  vec4 color = imageLoad(colorImage, pixel);
  float clear = exp(-density * imageLoad(positionImage, pixel).w);
  imageStore(foggyImage, pixel, vec4(mix(vec3(radiance), color.rgb, clear), color.a));
}

#else
#include "engine/graph/node.h"
#include "engine/plugin/registry.h"
#include "fog.comp.h"

namespace sample {

using namespace radivox;

class Fog : public graph::Node {
 public:
  static constexpr std::string_view kType = "sample.fog";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }

  void declare(graph::Declaration& d) override {
    d.read("color", "radiance, W/(m² sr)");
    d.read("position", "relative world m; w: distance along the view axis, 0: sky");
    d.write("color_in_fog", graph::Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, graph::Extent::of("width"), graph::Extent::of("height")),
            "radiance, W/(m² sr)");
  }

  void prepare(graph::PrepareContext& context) override {
    constexpr auto kImage = gpu::BindingType::StorageImage;
    pipeline_ = gpu::Pipeline(context.device(), gpu::ComputePipelineInfo{.shader = "sample/fog.comp",
                                                                         .code = fog_comp,
                                                                         .bindings = {kImage, kImage, kImage},
                                                                         .pushConstantBytes = sizeof(Push),
                                                                         .constants = {}});
  }

  void record(graph::RecordContext& context) override {
    const gpu::Image& foggy = context.image("color_in_fog");
    context.commands().bind(pipeline_, {context.image("color"), context.image("position"), foggy});
    context.commands().push(push_);
    context.commands().dispatch((foggy.info().width + 7) / 8, (foggy.info().height + 7) / 8);
  }

 private:
  struct Push {
    float density = 0.1f, radiance = 0.1f;
  };
  Push push_;
  params::Table table_{{params::number("density", &push_.density, {0, 100}, "share of light lost a metre, 1/m", params::Invalidates::Rerun),
                        params::number("radiance", &push_.radiance, {0, 1e6}, "of endless fog, W/(m² sr)", params::Invalidates::Rerun)}};
  gpu::Pipeline pipeline_;
};

void registerNodes(plugin::Registry& registry) { registry.add<Fog>("air that scatters, evenly lit"); }

}  // namespace sample

RADIVOX_MODULE(sample::registerNodes)
#endif
