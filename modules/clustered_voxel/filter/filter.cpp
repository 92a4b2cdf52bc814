#include "modules/clustered_voxel/filter/filter.h"

#include "modules/clustered_voxel/sky/sky.h"
#include "modules/clustered_voxel/structure.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Filter::Filter()
    : table_({params::swept(
                  params::number("radius", &radius_, {0, 8}, "half width of the kernel in voxels; 0: no filter", params::Invalidates::Plan),
                  {"0", "1", "2", "3"}, "0"),
              params::swept(params::number("passes", &passes_, {1, 4}, "how often the kernel is applied", params::Invalidates::Plan),
                            {"1", "2", "3"}, "1"),
              params::choice("weights", &weights_, {"surface", "gaussian"},
                             "surface: by distance, area, normal, plane, and no wall between; gaussian: the paper's, unlit faces dropped",
                             params::Invalidates::Plan)}) {}

void Filter::declare(graph::Declaration& d) {
  d.read("shown", "bit per face: in some pixel's stencil");
  d.read("needed", "bit per face: shown, or within the filter's reach");
  declareStructure(d);
  d.read("gathered", "E_indirect of each face, W/m²; a: sky visibility");
  readUnderImage(d, "gathered_sky", "E_sky of each face, W/m²");
  readSkyImage(d);  // only its version: the sky changed
  graph::Port& filteredSky = d.write("sky", Shape::buffer(16, Extent::of("faces")), "E_sky, W/m², filtered, of a sky with an image");
  filteredSky.persistent = true;
  filteredSky.optional = true;
  readEmission(d, "gathered_emitted", "irradiance of each face straight from emitters, W/m²");
  graph::Port& filteredEmitted =
      d.write("emitted", Shape::buffer(16, Extent::of("faces")), "irradiance straight from emitters, W/m², filtered");
  filteredEmitted.persistent = true;
  filteredEmitted.optional = true;
  d.read("cluster_radiosity", "only its version: the light changed");
  d.read("row_start", "only its version: the rays changed");
  d.write("irradiance", Shape::buffer(16, Extent::of("faces")), "E_indirect, W/m², filtered; a: sky visibility").persistent = true;
  LazyFaces::declare(d);
  // Passes before the last run over all needed faces, back and forth between these.
  if (radius_ > 0 && passes_ > 1) d.scratch("pass_a", Shape::buffer(16, Extent::of("faces")), "irradiance after odd passes");
  if (radius_ > 0 && passes_ > 2) d.scratch("pass_b", Shape::buffer(16, Extent::of("faces")), "irradiance after even passes");
}

void Filter::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  gpu::Device& device = context.device();
  faces_.prepare(device);
  hasSky_ = context.has("sky") && context.has("gathered_sky") && context.has("scene.sky");
  hasEmitted_ = context.has("emitted") && context.has("gathered_emitted");
  filter_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/filter/filter.comp",
                                                           .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                                           .pushConstantBytes = 12,
                                                           .constants = {{0, static_cast<uint32_t>(weights_)}}});
}

void Filter::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const bool stale = context.firstRun() || context.changed("cluster_radiosity") || context.changed("row_start") ||
                     context.changed("faces") || (hasSky_ && context.changed("scene.sky"));
  if (!faces_.record(context, context.buffer("shown"), false, stale)) return;
  recordPasses(context, context.buffer("gathered"), context.buffer("irradiance"));
  if (hasSky_) {
    commands.barrier();
    recordPasses(context, context.buffer("gathered_sky"), context.buffer("sky"));
  }
  if (hasEmitted_) {
    commands.barrier();
    recordPasses(context, context.buffer("gathered_emitted"), context.buffer("emitted"));
  }
}

void Filter::recordPasses(graph::RecordContext& context, const gpu::Buffer& gathered, const gpu::Buffer& filtered) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& status = context.buffer("status");
  // The last pass runs over the list alone; those before it over every needed face (mark's reach covers them all).
  const uint32_t passes = radius_ == 0 ? 1 : passes_;
  for (uint32_t pass = 0; pass < passes; ++pass) {
    const bool last = pass + 1 == passes;
    const gpu::Buffer& from = pass == 0 ? gathered : context.buffer(pass % 2 == 1 ? "pass_a" : "pass_b");
    const gpu::Buffer& to = last ? filtered : context.buffer(pass % 2 == 0 ? "pass_a" : "pass_b");
    bindStructure(context, filter_, {context.buffer("voxels"), context.buffer("needed"), context.buffer("list"), status, from, to});
    struct {
      uint32_t faceCount, radius, fromList;
    } push{faceCount, radius_, last ? 1u : 0u};
    commands.push(push);
    if (last) {
      commands.dispatchIndirect(status, LazyFaces::kArgumentsOffset);
    } else {
      commands.dispatchItems(faceCount, 64);
      commands.barrier();
    }
  }
}

void Filter::frameDone(graph::RecordContext& context) {
  uint32_t filtered = 0;
  std::memcpy(&filtered, context.buffer("status").mapped(), sizeof(filtered));
  context.reportStat("filtered_faces", filtered);
}

}  // namespace radivox::clustered_voxel
