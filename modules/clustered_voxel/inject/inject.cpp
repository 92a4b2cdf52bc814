#include "modules/clustered_voxel/inject/inject.h"

#include <algorithm>
#include <array>

#include "modules/clustered_voxel/sky/sky.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kGroup = 64;
constexpr uint64_t kTexelsPerRun = 16;  // splat.comp
}  // namespace

Inject::Inject()
    : table_({params::choice("method", &method_, {"splat", "points"},
                             "splat: the flux of every shadow-map texel; points: the paper's 18 points about each voxel",
                             params::Invalidates::Plan)}) {}

void Inject::declare(graph::Declaration& d) {
  lit_ = d.traits.hasPunctualLights() || d.traits.hasEmitters();
  for (const char* name : {"scene.info", "scene.lights", "scene.shadow_views", "scene.vertices", "scene.indices",
                           "scene.triangle_materials", "scene.materials"})
    d.read(name, "lights and geometry");
  d.read("shadow_depth", "depth of the nearest surface from each light, reversed z").optional = true;
  d.read("shadow_triangle", "id + 1 of the nearest triangle from each light, 0: none").optional = true;
  d.read("grid", "Grid");
  d.read("occupancy", "two words a brick");
  d.read("rank", "occupied voxels before the brick");
  d.read("voxels", "packed coordinate of each voxel");
  const char* noSplat = lit_ ? "no texels are splatted" : "nothing lights the scene";
  const bool splats = lit_ && method_ == Method::Splat;
  d.readIf(splats, "planes", "which faces each voxel has: shared/voxel_plane.h", noSplat).optional = true;
  d.readIf(splats, "mask", "faces of each voxel, where there are no planes", noSplat).optional = true;
  d.read("first", "first face of each voxel");
  d.read("faces", "Face");
  d.read("clusters", "Cluster");
  d.read("members", "members of the clusters, with their shares in its means: shared/cluster_member.h");
  d.readIf(lit_ && method_ == Method::Splat, "triangle_first", "first triangle of each voxel", "no texels are splatted");
  d.readIf(lit_ && method_ == Method::Splat, "triangle_ids", "triangles of each voxel, and faces they are no part of",
           "no texels are splatted");
  readSky(d);
  d.write("face_irradiance", Shape::buffer(12, Extent::of("faces")), "E_dir of each face, W/m²; 0: unlit");
  d.write("cluster_radiosity", Shape::buffer(12, Extent::of("clusters")), "reflected direct light, W/m²");
  d.readBack("status", Shape::buffer(4, 4), "texels without a face; lit texels, low and high word; 0");
  if (lit_ && method_ == Method::Splat)
    d.scratch("flux_high", Shape::buffer(12, Extent::of("faces")), "high words of the fixed-point Φ max(0, n·e_f) a face, RGB");
  if (lit_ && method_ == Method::Splat)
    d.scratch("table", Shape::buffer(4, Extent::of("shadow_views") + 2), "fixed-point exponent, then the first texel of each view");
}

void Inject::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::SampledImage;
  if (!context.has("shadow_triangle")) lit_ = false;
  hasSky_ = context.has("sky_irradiance");
  if (hasSky_) {
    addSky_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/inject/add_sky.comp",
                                                             .bindings = {kB, kB},
                                                             .pushConstantBytes = 4,
                                                             .constants = {{0, lit_ ? 1u : 0u}}});
  }
  if (lit_ && method_ == Method::Splat) {
    if (!context.has("planes") && !context.has("mask"))
      throw Error(ErrorCode::BadInput,
                  "clustered_voxel.inject: neither planes nor mask is connected; connect visibility.planes or faces.mask");
    splat_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/inject/splat.comp",
                                         .bindings = {kB, kB, kB, kB, kB, kI, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                         .pushConstantBytes = 12,
                                         .constants = {{0, context.traits().soleLight()},
                                                       {1, context.has("triangle_ids") ? 1u : 0u},
                                                       {2, context.has("planes") ? 2u : 1u},
                                                       {3, context.has("planes") ? 26u : 0u}}});
    resolve_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .shader = "clustered_voxel/inject/resolve.comp", .bindings = {kB, kB, kB, kB, kB, kB, kB}, .pushConstantBytes = 8});
  } else if (lit_) {
    points_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/inject/points.comp",
                                                             .bindings = {kB, kB, kB, kI, kB, kB, kB, kB, kB, kB},
                                                             .pushConstantBytes = 8});
  }
  clusters_ = gpu::Pipeline(
      device,
      gpu::ComputePipelineInfo{.shader = "clustered_voxel/inject/clusters.comp", .bindings = {kB, kB, kB, kB, kB}, .pushConstantBytes = 4});
}

void Inject::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const auto clusterCount = static_cast<uint32_t>(context.count("clusters"));
  const gpu::Buffer& irradiance = context.buffer("face_irradiance");
  const gpu::Buffer& radiosity = context.buffer("cluster_radiosity");
  const gpu::Buffer& status = context.buffer("status");
  commands.fill(status, 0);
  if ((!lit_ && !hasSky_) || faceCount == 0) {
    commands.fill(irradiance, 0);
    commands.fill(radiosity, 0);
    return;
  }
  struct {
    uint32_t viewCount, lightCount, faceCount;  // faceCount 0: make the table instead
  } push{static_cast<uint32_t>(context.count("shadow_views")), static_cast<uint32_t>(context.count("lights")), faceCount};

  if (lit_ && method_ == Method::Splat) {
    const gpu::Buffer& fluxHigh = context.buffer("flux_high");
    const gpu::Buffer& viewTable = context.buffer("table");
    // At most: tiles need not fill their layers; the shader stops at the last view.
    const uint64_t side = context.count("shadow_resolution"), texels = side * side * context.count("shadow_layers");
    const uint64_t runs = std::min(texels, texels / kTexelsPerRun + push.viewCount * side);
    commands.fill(irradiance, 0);  // the low words, until they are resolved
    commands.fill(fluxHigh, 0);
    commands.barrier();
    const std::vector<const gpu::Buffer*> lists =
        context.has("triangle_ids") ? context.grown("triangle_ids") : std::vector<const gpu::Buffer*>{};
    commands.bind(splat_, {context.buffer("scene.info"),
                           context.buffer("scene.lights"),
                           context.buffer("scene.shadow_views"),
                           context.buffer("scene.vertices"),
                           context.buffer("scene.indices"),
                           context.image("shadow_triangle"),
                           context.buffer("grid"),
                           context.buffer("occupancy"),
                           context.buffer("rank"),
                           context.has("planes") ? *context.grown("planes").front() : context.buffer("mask"),
                           context.buffer("first"),
                           irradiance,
                           viewTable,
                           status,
                           context.buffer("scene.triangle_materials"),
                           context.buffer("scene.materials"),
                           fluxHigh,
                           context.buffer("faces"),
                           context.buffer(lists.empty() ? "faces" : "triangle_first"),
                           lists.empty() ? context.buffer("faces") : *lists.front()});
    // First one lane: the table. Then every texel.
    push.faceCount = 0;
    commands.push(push);
    commands.dispatch(1);
    commands.barrier();
    push.faceCount = faceCount;
    commands.push(push);
    commands.dispatchItems(runs, kGroup);
    commands.barrier();
    commands.bind(resolve_, {context.buffer("faces"), context.buffer("grid"), irradiance, viewTable, fluxHigh,
                             context.buffer("scene.lights"), context.buffer("voxels")});
    commands.push(std::array{faceCount, push.lightCount});
    commands.dispatchItems(faceCount, kGroup);
  } else if (lit_) {
    commands.bind(points_, {context.buffer("scene.lights"), context.buffer("scene.shadow_views"), context.buffer("grid"),
                            context.image("shadow_depth"), context.buffer("occupancy"), context.buffer("rank"), context.buffer("voxels"),
                            context.buffer("faces"), irradiance, status});
    struct {
      uint32_t faceCount, lightCount;
    } pointsPush{faceCount, push.lightCount};
    commands.push(pointsPush);
    commands.dispatchItems(faceCount, kGroup);
  }
  commands.barrier();
  if (hasSky_) {
    commands.bind(addSky_, {context.buffer("sky_irradiance"), irradiance});
    commands.push(faceCount);
    commands.dispatchItems(faceCount, kGroup);
    commands.barrier();
  }
  commands.bind(clusters_, {context.buffer("faces"), context.buffer("clusters"), context.buffer("members"), irradiance, radiosity});
  commands.push(clusterCount);
  commands.dispatchItems(clusterCount, kGroup);
}

void Inject::frameDone(graph::RecordContext& context) {
  uint32_t words[4];
  std::memcpy(words, context.buffer("status").mapped(), sizeof(words));
  const double lit = static_cast<double>(words[1]) + 4294967296.0 * static_cast<double>(words[2]);
  context.reportStat("lit_texels", lit);
  context.reportStat("lost_texels", static_cast<double>(words[0]));
}

}  // namespace radivox::clustered_voxel
