#include "modules/clustered_voxel/sky/sky.h"

#include <array>

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;

graph::Port& readSky(graph::Declaration& d) {
  const char* nothingBounces = d.traits.whyNothingBounces();
  const bool bounces = (d.request.wantsIndirect() && nothingBounces == nullptr) || d.traits.keeps(scene::Feature::Bounces);
  return d.readIf(d.traits.hasSky() && bounces, "sky_irradiance", "E_sky of each face, W/m²",
                  !d.traits.hasSky()          ? "the scene has no sky"
                  : nothingBounces != nullptr ? nothingBounces
                                              : "0 bounces asked for");
}

void readSkyImage(graph::Declaration& d) { readUnderImage(d, "scene.sky", "the sky's image: means over bins and cells, texels"); }

void readUnderImage(graph::Declaration& d, const char* name, const char* meaning) {
  d.readIf(d.traits.skyImage, name, meaning, "the sky has no image");
}

void Sky::declare(graph::Declaration& d) {
  d.read("row_start", "first bit of each face's row in its chunk");
  d.read("entries", "visibility entries");
  d.read("chunk_table", "device address of each chunk");
  d.read("scene.info", "sky radiance");
  readSkyImage(d);
  d.write("irradiance", Shape::buffer(12, Extent::of("faces")), "E_sky of each face, W/m²");
}

void Sky::prepare(graph::PrepareContext& context) {
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  pipeline_ = gpu::Pipeline(context.device(), gpu::ComputePipelineInfo{.shader = "clustered_voxel/sky/sky.comp",
                                                                       .bindings = {kB, kB, kB, kB, kB},
                                                                       .pushConstantBytes = 8,
                                                                       .constants = {{0, context.has("scene.sky") ? 1u : 0u}}});
}

void Sky::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  if (faceCount == 0) return;
  commands.bind(pipeline_, {context.buffer("row_start"), context.buffer("chunk_table"), context.buffer("scene.info"),
                            context.buffer("irradiance"), context.buffer(context.has("scene.sky") ? "scene.sky" : "scene.info")});
  commands.push(std::array{faceCount, static_cast<uint32_t>(context.count("clusters"))});
  commands.dispatchItems(faceCount, 64);
}

}  // namespace radivox::clustered_voxel
