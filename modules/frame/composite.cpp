#include "modules/frame/composite.h"

#include "modules/frame/indirect.h"

namespace radivox::frame {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

void Composite::declare(graph::Declaration& d) {
  d.read("albedo", "ρ; a: 1 surface, 0 sky");
  d.read("emission", "L_e towards the viewer, W/(m² sr)");
  d.read("scene.info", "sky radiance");
  d.read("irradiance", "E_direct, W/m²").optional = true;
  graph::Port& indirect = d.read("indirect", "E_indirect, W/m²; a: sky visibility");
  indirect.optional = true;
  const char* noIndirect = whyNoIndirect(d);
  indirect.unwanted = noIndirect != nullptr && !d.traits.keeps(scene::Feature::Bounces);
  indirect.unwantedReason = indirect.unwanted ? noIndirect : "";
  constexpr const char* kNoImage = "the sky has no image";
  d.readIf(d.traits.skyImage, "sky", "E_sky, W/m²", kNoImage);
  d.readIf(d.traits.skyImage, "scene.sky", "the sky's image", kNoImage);
  d.readIf(d.traits.skyImage, "view.camera", "Camera", kNoImage);
  const Shape shape = Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height"));
  d.write("color", shape, "radiance, W/(m² sr); a: 1 surface, 0 sky");
  d.write("direct", shape, "ρ E_direct / π, with the sky's light").optional = true;
  d.write("indirect_radiance", shape, "ρ E_indirect / π").optional = true;
  d.write("irradiance_direct", shape, "E_direct with the sky's light, W/m²").optional = true;
}

void Composite::prepare(graph::PrepareContext& context) {
  constexpr auto kI = BindingType::StorageImage;
  constexpr auto kB = BindingType::StorageBuffer;
  hasBackground_ = context.has("scene.sky") && context.has("view.camera");
  pipeline_ = gpu::Pipeline(context.device(), gpu::ComputePipelineInfo{.shader = "frame/composite.comp",
                                                                       .bindings = {kI, kI, kI, kI, kB, kI, kI, kI, kI, kI, kB, kB},
                                                                       .constants = {{0, context.has("irradiance")},
                                                                                     {1, context.has("indirect")},
                                                                                     {2, context.request().wantsIndirect()},
                                                                                     {3, context.has("direct")},
                                                                                     {4, context.has("indirect_radiance")},
                                                                                     {5, context.has("irradiance_direct")},
                                                                                     {6, context.has("sky")},
                                                                                     {7, hasBackground_}}});
}

void Composite::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  gpu::Image& color = context.image("color");
  const auto find = [&](const char* port) -> const gpu::Image& { return context.has(port) ? context.image(port) : absent_; };
  commands.bind(pipeline_, {context.image("albedo"), context.image("emission"), find("irradiance"), find("indirect"),
                            context.buffer("scene.info"), color, find("direct"), find("indirect_radiance"), find("irradiance_direct"),
                            find("sky"), context.buffer(hasBackground_ ? "scene.sky" : "scene.info"),
                            context.buffer(hasBackground_ ? "view.camera" : "scene.info")});
  commands.dispatch((color.info().width + 7) / 8, (color.info().height + 7) / 8);
}

}  // namespace radivox::frame
