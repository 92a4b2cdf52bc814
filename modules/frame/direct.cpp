#include "modules/frame/direct.h"

#include "modules/frame/indirect.h"

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
    : table_(
          {params::choice(
               "edges", &edges_, {"exact", "filtered"},
               "shadows of punctual lights end where triangles end (smoothed over the pixel), or where shadow texels do (filtered)",
               params::Invalidates::Plan),
           params::flag(
               "rays", &rays_,
               "edges=exact: where the voxels' triangles are connected, rays through them decide, and shadow maps only where edges may be",
               params::Invalidates::Plan),
           params::choice("sides", &sides_, {"both", "gltf"}, "of the surfaces that rays meet, as shadow_map.sides",
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

  const char* noIndirect = whyNoIndirect(d);
  const bool rays = rays_ && edges_ == Edges::Exact && d.traits.hasPunctualLights() && noIndirect == nullptr;
  const std::string noRays = noIndirect != nullptr ? noIndirect : "shadows come from maps alone";
  for (const auto& [name, meaning] : {std::pair{"grid", "Grid"},
                                      {"occupancy", "two words a brick"},
                                      {"rank", "occupied voxels before the brick"},
                                      {"distance", "bricks to the nearest occupied brick, four bytes a word"},
                                      {"clearance", "the empty box around each voxel"},
                                      {"triangle_first", "first triangle of each voxel"},
                                      {"triangle_ids", "triangles of each voxel"},
                                      {"corners", "corners of triangles"}})
    d.readIf(rays, name, meaning, noRays);
  d.readIf(rays && d.traits.hasAlphaMasks(), "scene.textures", "Texture", "no alpha masks");

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
  hasRays_ = shadowed && context.has("grid") && context.has("occupancy") && context.has("rank") && context.has("distance") &&
             context.has("triangle_first") && context.has("triangle_ids");
  constexpr uint32_t kSkipBricks = 1, kSkipClearance = 2;
  const auto pipeline = [&](uint32_t skip) {
    return gpu::Pipeline(context.device(),
                         gpu::ComputePipelineInfo{.shader = "frame/direct.comp",
                                                  .bindings = {kI, kI, kI, kB, kB, kB, kB, kB, kB, kS, kS, kI, kI,
                                                               kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                                  .constants = {{0, filter_},
                                                                {1, shadowed},
                                                                {2, static_cast<uint32_t>(emitters_)},
                                                                {3, context.traits().hasAlphaMasks()},
                                                                {4, edges_ == Edges::Exact && context.traits().hasPunctualLights()},
                                                                {5, context.traits().soleLight()},
                                                                {6, hasRays_},
                                                                {7, skip},
                                                                {8, context.has("corners")},
                                                                {9, context.traits().hasSingleSides() && sides_ == Sides::Gltf}}});
  };
  pipeline_ = pipeline(kSkipBricks);
  if (hasRays_ && context.has("clearance")) clearancePipeline_ = pipeline(kSkipClearance);
}

void Direct::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  gpu::Image& out = context.image("irradiance");
  const gpu::Image& position = context.image("position");
  const bool shadowed = context.has("shadow_depth") && context.has("shadow_triangle");
  // What is absent is never read: another buffer takes its binding.
  const gpu::Buffer& lights = context.buffer("scene.lights");
  const auto optional = [&](const char* name) -> const gpu::Buffer& { return context.has(name) ? context.buffer(name) : lights; };
  const auto grown = [&](const char* name) -> const gpu::Buffer* {
    if (!hasRays_ || !context.has(name)) return nullptr;
    const std::vector<const gpu::Buffer*> all = context.grown(name);
    return all.empty() ? nullptr : all.front();
  };
  // Visibility makes no clearance where its parameters or the size of the grid ask for bricks.
  const gpu::Buffer* clearance = grown("clearance");
  const gpu::Buffer* ids = grown("triangle_ids");
  commands.bind(clearance != nullptr ? clearancePipeline_ : pipeline_, {position,
                                                                        context.image("normal"),
                                                                        context.image("triangle"),
                                                                        context.buffer("scene.vertices"),
                                                                        context.buffer("scene.indices"),
                                                                        context.buffer("scene.info"),
                                                                        lights,
                                                                        context.buffer("scene.shadow_views"),
                                                                        context.buffer("scene.emissive_triangles"),
                                                                        shadowed ? context.image("shadow_depth") : absent_,
                                                                        shadowed ? context.image("shadow_triangle") : absent_,
                                                                        emitters_ == Emitters::Image ? context.image("emitted") : absent_,
                                                                        out,
                                                                        context.buffer("scene.triangle_materials"),
                                                                        context.buffer("scene.materials"),
                                                                        context.buffer("view.camera"),
                                                                        optional("grid"),
                                                                        optional("occupancy"),
                                                                        optional("rank"),
                                                                        optional("distance"),
                                                                        clearance != nullptr ? *clearance : lights,
                                                                        optional("triangle_first"),
                                                                        ids != nullptr ? *ids : lights,
                                                                        optional("corners"),
                                                                        optional("scene.textures")});
  commands.dispatch((out.info().width + 7) / 8, (out.info().height + 7) / 8);
  if (emitters_ == Emitters::Unshadowed)
    context.reportStat("emitters_unshadowed", static_cast<double>(context.traits().emissiveTriangleCount));
  if (emitters_ == Emitters::None && context.traits().emissiveTriangleCount > 0)
    context.reportStat("emitters_left_out", static_cast<double>(context.traits().emissiveTriangleCount));
}

}  // namespace radivox::frame
