#include "modules/clustered_voxel/gather/gather.h"

#include "modules/clustered_voxel/sky/sky.h"
#include "modules/clustered_voxel/structure.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

Gather::Gather()
    : table_(
          {params::choice("estimator", &estimator_, {"counted", "differential"},
                          "counted: form factors from ray counts; differential: the paper's cosθ cosθ'/(π d²)", params::Invalidates::Plan),
           params::flag("lazy", &lazy_, "gather only the faces that the view needs; off: all of them (tests)",
                        params::Invalidates::Rerun)}) {}

void Gather::declare(graph::Declaration& d) {
  if (estimator_ == Estimator::Differential && d.request.aovs.count("error") != 0)
    throw Error(
        ErrorCode::BadInput,
        "gather.estimator=differential has no ray counts to tell an error by; leave AOV error out, or use gather.estimator=counted");
  d.read("needed", "bit per face");
  d.read("row_start", "first bit of each face's row in its chunk");
  d.read("entries", "visibility entries");
  d.read("chunk_table", "device address of each chunk");
  d.read("faces", "Face");
  d.read("voxels", "packed coordinate of each voxel");
  d.readIf(estimator_ == Estimator::Differential, "cluster_places", "ClusterPlace", "rays are counted, wherever clusters are").optional =
      estimator_ != Estimator::Differential;
  d.read("cluster_radiosity", "reflected radiosity, W/m²");
  d.read("face_radiosity", "reflected radiosity, W/m²");
  d.write("irradiance", Shape::buffer(16, Extent::of("faces")), "E_indirect, W/m²; a: sky visibility").persistent = true;
  readSkyImage(d);
  readUnderImage(d, "scene.info", "sky radiance");
  graph::Port& sky = d.write("sky", Shape::buffer(16, Extent::of("faces")), "E_sky, W/m², of a sky with an image");
  sky.persistent = true;
  sky.optional = true;
  readEmission(d, "emission", "mean B_e of each face, W/m²");
  readEmission(d, "cluster_emission", "mean B_e of each cluster, W/m²");
  graph::Port& emitted = d.write("emitted", Shape::buffer(16, Extent::of("faces")), "irradiance straight from emitters, W/m²");
  emitted.persistent = true;
  emitted.optional = true;
  graph::Port& error = d.write("error", Shape::buffer(12, Extent::of("faces")), "standard error of E_indirect, W/m²");
  error.persistent = true;
  error.optional = true;
  LazyFaces::declare(d);
}

void Gather::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  gpu::Device& device = context.device();
  hasSky_ = context.has("sky") && context.has("scene.sky");
  hasEmitted_ = context.has("emitted") && context.has("emission") && context.has("cluster_emission");
  faces_.prepare(device);
  gather_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather/gather.comp",
                                                           .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                                           .pushConstantBytes = 8,
                                                           .constants = {{0, static_cast<uint32_t>(estimator_)},
                                                                         {1, context.has("error") ? 1u : 0u},
                                                                         {2, hasSky_ ? 1u : 0u},
                                                                         {3, hasEmitted_ ? 1u : 0u}}});
}

void Gather::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& status = context.buffer("status");
  // Only a new view leaves earlier results standing.
  const bool stale = context.firstRun() || context.changed("cluster_radiosity") || context.changed("face_radiosity") ||
                     context.changed("entries") || context.changed("row_start") || context.changed("chunk_table") ||
                     context.changed("faces") || context.changed("voxels") ||
                     (context.has("cluster_places") && context.changed("cluster_places")) ||
                     (hasSky_ && (context.changed("scene.sky") || context.changed("scene.info"))) ||
                     (hasEmitted_ && (context.changed("emission") || context.changed("cluster_emission")));
  if (!faces_.record(context, context.buffer("needed"), !lazy_, stale)) return;
  commands.bind(gather_, {context.buffer("list"), status, context.buffer("row_start"), context.buffer("chunk_table"),
                          context.buffer(context.has("cluster_places") ? "cluster_places" : "faces"), context.buffer("cluster_radiosity"),
                          context.buffer("face_radiosity"), context.buffer("faces"), context.buffer("voxels"), context.buffer("irradiance"),
                          context.buffer(context.has("error") ? "error" : "irradiance"), context.buffer(hasSky_ ? "scene.sky" : "faces"),
                          context.buffer(hasSky_ ? "scene.info" : "faces"), context.buffer(hasSky_ ? "sky" : "irradiance"),
                          context.buffer(hasEmitted_ ? "emission" : "faces"), context.buffer(hasEmitted_ ? "cluster_emission" : "faces"),
                          context.buffer(hasEmitted_ ? "emitted" : "irradiance")});
  struct {
    uint32_t clusterCount, faceCount;
  } push{static_cast<uint32_t>(context.count("clusters")), faceCount};
  commands.push(push);
  commands.dispatchIndirect(status, LazyFaces::kArgumentsOffset);
}

void Gather::frameDone(graph::RecordContext& context) {
  uint32_t gathered = 0;
  std::memcpy(&gathered, context.buffer("status").mapped(), sizeof(gathered));
  context.reportStat("gathered_faces", gathered);
}

}  // namespace radivox::clustered_voxel
