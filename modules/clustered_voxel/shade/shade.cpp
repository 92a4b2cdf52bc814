#include "modules/clustered_voxel/shade/shade.h"

#include "modules/clustered_voxel/sky/sky.h"
#include "modules/clustered_voxel/structure.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Shade::Shade()
    : table_({params::choice("interpolation", &interpolation_, {"trilinear", "nearest"},
                             "trilinear over the faces about the pixel, or its own voxel's face alone", params::Invalidates::Plan)}) {}

void Shade::declare(graph::Declaration& d) {
  d.read("position", "relative world m, w: distance along the view axis, 0: sky");
  d.read("normal", "unit shading normal");
  declareStructure(d);
  d.read("filtered", "E_indirect of each face, W/m²; a: sky visibility");
  d.read("valid", "bit per face");
  d.write("irradiance", Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")),
          "E_indirect, W/m²; a: sky visibility; 0 on the sky");
  readUnderImage(d, "filtered_sky", "E_sky of each face, W/m²");
  d.write("sky", Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")),
          "E_sky, W/m², of a sky with an image; 0 on the sky")
      .optional = true;
  readEmission(d, "filtered_emitted", "irradiance of each face straight from emitters, W/m²");
  d.write("emitted", Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")),
          "irradiance straight from emitters, W/m², where these light by rays; 0 on the sky")
      .optional = true;
  // Its source is read only where the picture is wanted.
  const bool wantsError = d.request.aovs.count("error") != 0;
  graph::Port& source = d.read("face_error", "standard error of E_indirect of each face, W/m²");
  source.optional = true;
  source.unwanted = !wantsError;
  source.unwantedReason = "no AOV error";
  d.write("error", Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")),
          "standard error of E_indirect, W/m²; 0 on the sky")
      .optional = true;
}

void Shade::prepare(graph::PrepareContext& context) {
  hasSky_ = context.has("sky") && context.has("filtered_sky");
  hasEmitted_ = context.has("emitted") && context.has("filtered_emitted");
  wantsError_ = context.has("error") && context.has("face_error");
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  shade_ = gpu::Pipeline(
      context.device(),
      gpu::ComputePipelineInfo{
          .shader = "clustered_voxel/shade/shade.comp",
          .bindings = {kB, kB, kB, kB, kB, kB, kI, kI, kB, kB, kI, kB, kI, kB, kI, kB, kI},
          .pushConstantBytes = 8,
          .constants = {
              {0, static_cast<uint32_t>(interpolation_)}, {1, wantsError_ ? 1u : 0u}, {2, hasSky_ ? 1u : 0u}, {3, hasEmitted_ ? 1u : 0u}}});
}

void Shade::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Image& out = context.image("irradiance");
  struct {
    uint32_t width, height;
  } push{out.info().width, out.info().height};
  bindStructure(context, shade_,
                {context.image("position"), context.image("normal"), context.buffer("filtered"), context.buffer("valid"), out,
                 context.buffer(wantsError_ ? "face_error" : "filtered"), wantsError_ ? context.image("error") : out,
                 context.buffer(hasSky_ ? "filtered_sky" : "filtered"), hasSky_ ? context.image("sky") : out,
                 context.buffer(hasEmitted_ ? "filtered_emitted" : "filtered"), hasEmitted_ ? context.image("emitted") : out});
  commands.push(push);
  commands.dispatchItems(uint64_t{push.width} * push.height, 64);
}

}  // namespace radivox::clustered_voxel
