#include "modules/frame/direct.h"

namespace radivox::frame {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr VkFormat kFloat4 = VK_FORMAT_R32G32B32A32_SFLOAT;
/// Most emissive triangles that a pixel sums when there are neither samples nor an image of emitted light.
constexpr uint32_t kMaxUnshadowed = 4096;
}  // namespace

Direct::Direct()
    : table_({params::choice(
                  "edges", &edges_, {"exact", "filtered"},
                  "shadows of punctual lights end where triangles end (smoothed over the pixel), or where shadow texels do (filtered)",
                  params::Invalidates::Plan),
              params::number("filter", &filter_, {0, 3},
                             "widest half width of the shadow filter, texels: emitter samples, and edges=filtered; 0: none",
                             params::Invalidates::Plan),
              params::number("closed_form", &closedForm_, {0, kMaxUnshadowed},
                             "emissive triangles up to this many are summed in closed form, above it emitter samples stand for them",
                             params::Invalidates::Plan)}) {}

Direct::Emitters Direct::chooseEmitters(const scene::Traits& traits, bool hasImage) const {
  if (!traits.hasEmitters()) return Emitters::None;
  if (!traits.emittersByRays) return traits.emissiveTriangleCount <= closedForm_ ? Emitters::Shadowed : Emitters::Samples;
  if (hasImage) return Emitters::Image;
  return traits.emissiveTriangleCount <= kMaxUnshadowed ? Emitters::Unshadowed : Emitters::None;
}

void Direct::declare(graph::Declaration& d) {
  if (!d.traits.hasPunctualLights() && !d.traits.hasEmitters()) {
    d.leaveOut("no lights and no emitters");
    return;
  }
  d.read("position", "relative world m");
  d.read("normal", "unit shading normal on the viewer's side");
  d.read("triangle", "id + 1; 0: sky");
  for (const char* name : {"scene.vertices", "scene.indices", "scene.info", "scene.lights", "scene.shadow_views",
                           "scene.emissive_triangles", "scene.triangle_materials", "scene.materials"})
    d.read(name, "geometry and lights");
  d.read("view.camera", "Camera");
  d.read("shadow_depth", "reversed z of the nearest surface from each light").optional = true;
  d.read("shadow_triangle", "id + 1 of that surface; 0: none").optional = true;
  graph::Port& emitted = d.read("emitted", "irradiance from emitters, found by rays, W/m²");
  emitted.optional = true;
  emitted.unwanted = d.traits.emissiveTriangleCount == 0 || !d.traits.emittersByRays;
  emitted.unwantedReason = d.traits.emissiveTriangleCount == 0 ? "no emitters" : "emitters have samples with shadow maps";

  std::string meaning = "E_direct, W/m², without the sky; a: 1 surface, 0 sky";
  switch (chooseEmitters(d.traits, false)) {
    case Emitters::None:
      break;
    case Emitters::Shadowed:
      meaning += "; emitters in closed form, shadowed by samples";
      break;
    case Emitters::Samples:
      meaning += "; emitters by samples";
      break;
    case Emitters::Unshadowed:
      meaning += "; emitters from `emitted`, or without it unshadowed";
      break;
    case Emitters::Image:
      break;
  }
  d.write("irradiance", Shape::image(kFloat4, Extent::of("width"), Extent::of("height")), std::move(meaning));
}

void Direct::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  constexpr auto kS = BindingType::SampledImage;
  emitters_ = chooseEmitters(context.traits(), context.has("emitted"));
  const bool shadowed = context.has("shadow_depth") && context.has("shadow_triangle");
  pipeline_ = gpu::Pipeline(context.device(),
                            gpu::ComputePipelineInfo{.shader = "frame/direct.comp",
                                                     .bindings = {kI, kI, kI, kB, kB, kB, kB, kB, kB, kS, kS, kI, kI, kB, kB, kB},
                                                     .constants = {{0, filter_},
                                                                   {1, shadowed},
                                                                   {2, static_cast<uint32_t>(emitters_)},
                                                                   {3, context.traits().hasAlphaMasks()},
                                                                   {4, edges_ == Edges::Exact && context.traits().hasPunctualLights()},
                                                                   {5, context.traits().soleLight()}}});
}

void Direct::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  gpu::Image& out = context.image("irradiance");
  const gpu::Image& position = context.image("position");
  const bool shadowed = context.has("shadow_depth") && context.has("shadow_triangle");
  commands.bind(pipeline_, {position, context.image("normal"), context.image("triangle"), context.buffer("scene.vertices"),
                            context.buffer("scene.indices"), context.buffer("scene.info"), context.buffer("scene.lights"),
                            context.buffer("scene.shadow_views"), context.buffer("scene.emissive_triangles"),
                            shadowed ? context.image("shadow_depth") : absent_, shadowed ? context.image("shadow_triangle") : absent_,
                            emitters_ == Emitters::Image ? context.image("emitted") : absent_, out,
                            context.buffer("scene.triangle_materials"), context.buffer("scene.materials"), context.buffer("view.camera")});
  commands.dispatch((out.info().width + 7) / 8, (out.info().height + 7) / 8);
  if (emitters_ == Emitters::Unshadowed)
    context.reportStat("emitters_unshadowed", static_cast<double>(context.traits().emissiveTriangleCount));
  if (emitters_ == Emitters::None && context.traits().emissiveTriangleCount > 0)
    context.reportStat("emitters_left_out", static_cast<double>(context.traits().emissiveTriangleCount));
}

}  // namespace radivox::frame
