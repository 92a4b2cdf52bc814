#include "modules/clustered_voxel/gather_pixels/gather_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "modules/clustered_voxel/sky/sky.h"
#include "modules/clustered_voxel/structure.h"
#include "modules/clustered_voxel/voxelize/triangles.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kBlock = 4;  // pixels a side of an interleaving block; the shaders know it too
// Where voxels hold many triangles a ray takes a thousand rounds of loops, and llvmpipe ends a lane's after 65535.
constexpr uint32_t kRaysPerDispatch = 48;
// Inputs that no ray's way depends on.
constexpr std::array<std::string_view, 10> kLight{"face_radiosity", "shadow_depth", "shadow_triangle", "face_irradiance",
                                                  "sky_irradiance", "emission",     "scene.lights",    "scene.shadow_views",
                                                  "scene.info",     "scene.sky"};
// What a dispatch does (trace.comp).
constexpr uint32_t kTraceAndLight = 0, kTraceOnly = 1, kLightOnly = 2;
}  // namespace

std::vector<glm::vec2> sobolPoints(uint32_t count) {
  std::vector<glm::vec2> out;
  out.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t a = 0, b = 0;
    for (uint32_t bits = i, v = 1u << 31, w = 1u << 31; bits != 0; bits >>= 1, v >>= 1, w ^= w >> 1)
      if ((bits & 1u) != 0) {
        a ^= v;
        b ^= w;
      }
    out.emplace_back(static_cast<float>((a + 0.5) / 4294967296.0), static_cast<float>((b + 0.5) / 4294967296.0));
  }
  return out;
}

GatherPixels::GatherPixels()
    : table_({params::swept(
                  params::number("rays", &rays_, {1, 256}, "voxel rays a pixel; a 4×4 block of pixels shares 16 times as many directions",
                                 params::Invalidates::Plan),
                  {"4", "8", "16", "32", "64"}, "256"),
              params::swept(params::number("near", &near_, {0.0, 4096.0}, "rays test triangles up to this distance, voxels; 0: voxels only",
                                           params::Invalidates::Plan),
                            {"0", "2", "4", "8"}, "4096"),
              params::flag("shadow", &shadow_, "hits on near triangles look their direct light up in the shadow maps",
                           params::Invalidates::Plan),
              params::swept(
                  params::number(
                      "smooth", &smooth_, {0, 4},
                      "extra passes of the filter, each twice as wide; they stop at edges, and where light differs by more than its noise",
                      params::Invalidates::Plan),
                  {"0", "1", "2", "3"}, "0"),
              params::flag("keep", &keep_,
                           "keep what each ray hit, 8 B a ray: while only light changes none is traced again, to the same result",
                           params::Invalidates::Plan)}) {}

void GatherPixels::declare(graph::Declaration& d) {
  const Shape image = Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height"));
  d.read("position", "relative world m, w: distance along the view axis, 0: sky");
  d.read("normal", "unit shading normal");
  declareStructure(d, false);
  d.read("distance", "bricks to the nearest occupied brick, four bytes a word");
  d.read("planes", "what rays are stopped by");
  d.read("plane_extras", "where the planes of a voxel after its first are");
  d.read("clearance", "the empty box around each voxel").optional = true;
  d.read("face_radiosity", "reflected radiosity, W/m²");
  // Emitters shine from many samples: too many to look up one by one.
  const bool shadow = near_ > 0.f && shadow_ && d.traits.emissiveTriangleCount == 0 && d.traits.punctualLightCount() > 0;
  const bool masked = near_ > 0.f && d.traits.alphaMasked;
  constexpr const char* kNoTriangles = "gather_pixels.near is 0: rays test no triangles";
  d.read("triangle", "id + 1 of the pixel's triangle");
  d.readIf(near_ > 0.f, "triangle_first", "first triangle of each voxel", kNoTriangles);
  d.readIf(near_ > 0.f, "triangle_ids", "triangles of each voxel", kNoTriangles);
  readCorners(d, near_ > 0.f, "gather_pixels.near is 0");
  d.readIf(near_ > 0.f, "scene.vertices", "Vertex", kNoTriangles);
  d.readIf(near_ > 0.f, "scene.indices", "three a triangle", kNoTriangles);
  constexpr const char* kNoShadow =
      "gather_pixels.near and shadow are off, or emitters light the scene: hits take their face's direct light";
  d.readIf(shadow, "shadow_depth", "depth of the nearest surface from each light", kNoShadow);
  d.readIf(shadow, "shadow_triangle", "its id + 1", kNoShadow);
  d.readIf(shadow, "face_irradiance", "E_dir of each face, W/m²", kNoShadow);
  d.readIf(shadow, "scene.lights", "Light", kNoShadow);
  d.readIf(shadow, "scene.shadow_views", "ShadowView", kNoShadow);
  d.readIf(masked || shadow, "scene.triangle_materials", "one a triangle", "no near triangle has an alpha mask");
  d.readIf(masked || shadow, "scene.materials", "Material", "no near triangle has an alpha mask");
  d.readIf(masked, "scene.textures", "Texture", "no near triangle has an alpha mask");
  if (graph::Port& sky = readSky(d); !shadow) {
    sky.unwanted = true;
    sky.unwantedReason = kNoShadow;
  }
  d.write("irradiance", image, "E_indirect, W/m²; a: sky visibility; 0 on the sky");
  readSkyImage(d);
  readUnderImage(d, "scene.info", "sky radiance");
  d.write("sky", image, "E_sky, W/m², of a sky with an image; 0 on the sky").optional = true;
  readEmission(d, "emission", "mean B_e of each face, W/m²");
  d.write("emitted", image, "irradiance from emitters, found by the rays, W/m²; 0 on the sky").optional = true;
  if (keep_)
    d.write("hits", Shape::buffer(8, Extent::of("width") * "height" * rays_),
            "face and triangle that each ray hit; a plane of pixels a ray", graph::UseAddress | graph::UseTransfer)
        .persistent = true;
  ways_.clear();
  for (const graph::Port& port : d.ports)
    if (port.access == graph::Access::Read && std::find(kLight.begin(), kLight.end(), port.name) == kLight.end())
      ways_.push_back(port.name);
  // A filter of several passes knows the noise of what it smooths.
  const auto spread = [](bool evenSky) { return Shape::buffer((evenSky ? 2 : 1) * sizeof(float), Extent::of("width") * "height"); };
  const bool evenSky = d.traits.sky && !d.traits.skyImage;
  if (smooth_ > 0) d.scratch("between_spread", spread(evenSky), "variance of luminance between filter passes, and of sky visibility");
  const auto raw = [&](const std::string& suffix, const std::string& what) {
    d.scratch("raw" + suffix, image, what + " from each pixel's own rays");
    if (smooth_ == 0) return;
    d.scratch("between" + suffix, image, what + " between filter passes");
    d.scratch("spread" + suffix, spread(evenSky && suffix.empty()),
              "of each pixel's rays the mean square of luminance; then the variance between filter passes");
  };
  if (d.traits.hasEmissionByRays()) raw("_emitted", "the emitters'");
  if (d.traits.skyImage) raw("_sky", "E_sky");
  raw("", "E_indirect");
}

void GatherPixels::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  gpu::Device& device = context.device();
  const std::vector<glm::vec2> directions = sobolPoints(kBlock * kBlock * rays_);
  directions_ = gpu::Buffer(device, "gather_pixels.directions", directions.size() * sizeof(glm::vec2));
  gpu::upload(device, directions_, directions);
  hasTriangles_ = context.has("triangle_ids");
  isMasked_ = hasTriangles_ && context.traits().alphaMasked;
  hasShadow_ = context.has("shadow_depth");
  hasSky_ = context.has("sky") && context.has("scene.sky");
  hasEvenSky_ = context.traits().sky && !context.traits().skyImage;
  hasEmitted_ = context.has("emitted") && context.has("emission");
  std::vector<BindingType> bindings(32, kB);
  for (const size_t map : {25, 26}) bindings[map] = BindingType::SampledImage;
  for (const size_t image : {6, 7, 11, 15, 30, 31}) bindings[image] = kI;
  const auto trace = [&](uint32_t skip, uint32_t work) {
    return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather_pixels/trace.comp",
                                                          .bindings = bindings,
                                                          .pushConstantBytes = 88,
                                                          .constants = {{0, skip},
                                                                        {1, hasTriangles_ ? 1u : 0u},
                                                                        {2, isMasked_ ? 1u : 0u},
                                                                        {3, hasShadow_ ? 1u : 0u},
                                                                        {4, context.has("corners") ? 1u : 0u},
                                                                        {5, context.has("sky_irradiance") ? 1u : 0u},
                                                                        {6, hasSky_ ? 1u : 0u},
                                                                        {7, hasEmitted_ ? 1u : 0u},
                                                                        {8, smooth_ > 0 ? 1u : 0u},
                                                                        {9, work}}});
  };
  traceBricks_ = trace(1, keep_ ? kTraceOnly : kTraceAndLight);
  if (context.has("clearance")) trace_ = trace(2, keep_ ? kTraceOnly : kTraceAndLight);
  if (keep_) light_ = trace(1, kLightOnly);
  const auto filter = [&](bool evenSky) {
    return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/gather_pixels/filter.comp",
                                                          .bindings = {kB, kI, kI, kI, kI, kB, kB},
                                                          .pushConstantBytes = 20,
                                                          .constants = {{0, smooth_ > 0 ? 1u : 0u}, {1, evenSky ? 1u : 0u}}});
  };
  filter_ = filter(hasEvenSky_);
  if (hasSky_ || hasEmitted_) lightFilter_ = filter(false);
}

bool GatherPixels::waysChanged(graph::RecordContext& context) const {
  return context.firstRun() || std::any_of(ways_.begin(), ways_.end(), [&](const std::string& port) { return context.changed(port); });
}

void GatherPixels::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Image& position = context.image("position");
  const gpu::Image& normal = context.image("normal");
  const gpu::Image& raw = context.image("raw");
  const auto spread = [&](const char* name, bool present) { return smooth_ > 0 && present ? context.buffer(name).address() : 0; };
  struct {
    uint32_t width, height, rays, firstRay, endRay, voxelCount;
    float near;
    uint32_t lightCount;
    VkDeviceAddress sky, skyInfo, emission, squares, skySquares, emittedSquares, hits;
  } push{raw.info().width,
         raw.info().height,
         rays_,
         0,
         0,
         static_cast<uint32_t>(context.count("voxels")),
         near_,
         hasShadow_ ? static_cast<uint32_t>(context.count("lights")) : 0u,
         hasSky_ ? context.buffer("scene.sky").address() : 0,
         hasSky_ ? context.buffer("scene.info").address() : 0,
         hasEmitted_ ? context.buffer("emission").address() : 0,
         spread("spread", true),
         spread("spread_sky", hasSky_),
         spread("spread_emitted", hasEmitted_),
         keep_ ? context.buffer("hits").address() : 0};
  // No planes where there are no voxels.
  const std::vector<const gpu::Buffer*> planes = context.grown("planes");
  // Visibility makes no clearance where its parameters or the size of the grid ask for bricks.
  std::vector<const gpu::Buffer*> grown;
  if (context.has("clearance")) grown = context.grown("clearance");
  const gpu::Buffer& distance = context.buffer("distance");
  // What is absent is never read: another buffer or image takes its binding.
  std::vector<const gpu::Buffer*> ids;
  if (hasTriangles_) ids = context.grown("triangle_ids");
  const auto optional = [&](const char* name, bool present) -> const gpu::Buffer& { return present ? context.buffer(name) : distance; };
  const auto map = [&](const char* name) -> const gpu::Image& { return hasShadow_ ? context.image(name) : absent_; };
  // Lanes side by side hold pixels of the same place in their blocks: they walk along the same directions.
  const uint64_t blocks = uint64_t{(push.width + kBlock - 1) / kBlock} * ((push.height + kBlock - 1) / kBlock);
  const auto run = [&](const gpu::Pipeline& pipeline) {
    bindStructure(context, pipeline,
                  {position,
                   normal,
                   distance,
                   context.buffer("face_radiosity"),
                   directions_,
                   raw,
                   planes.empty() ? distance : *planes.front(),
                   context.buffer("plane_extras"),
                   grown.empty() ? distance : *grown.front(),
                   context.image("triangle"),
                   optional("triangle_first", hasTriangles_),
                   ids.empty() ? distance : *ids.front(),
                   optional("scene.vertices", hasTriangles_),
                   optional("scene.indices", hasTriangles_),
                   optional("scene.triangle_materials", isMasked_ || hasShadow_),
                   optional("scene.materials", isMasked_ || hasShadow_),
                   optional("scene.textures", isMasked_),
                   optional("scene.lights", hasShadow_),
                   optional("scene.shadow_views", hasShadow_),
                   map("shadow_depth"),
                   map("shadow_triangle"),
                   optional("face_irradiance", hasShadow_),
                   optional("corners", context.has("corners")),
                   optional("sky_irradiance", context.has("sky_irradiance")),
                   hasEmitted_ ? context.image("raw_emitted") : absent_,
                   hasSky_ ? context.image("raw_sky") : absent_},
                  "first");
    for (push.firstRay = 0; push.firstRay < rays_; push.firstRay = push.endRay) {
      if (push.firstRay > 0) commands.barrier();
      push.endRay = std::min(rays_, push.firstRay + kRaysPerDispatch);
      commands.push(push);
      commands.dispatchItems(blocks * kBlock * kBlock, 64);
    }
  };
  const bool traces = !keep_ || waysChanged(context);
  if (traces) run(grown.empty() ? traceBricks_ : trace_);
  if (keep_) {
    if (traces) commands.barrier();
    run(light_);
    const double all = static_cast<double>(rays_) * push.width * push.height;
    context.reportStat("rays", all);
    context.reportStat("traced_rays", traces ? all : 0.0);
  }

  filter(context, "", "irradiance");
  if (hasSky_) filter(context, "_sky", "sky");
  if (hasEmitted_) filter(context, "_emitted", "emitted");
}

void GatherPixels::filter(graph::RecordContext& context, const std::string& suffix, const char* outName) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& grid = context.buffer("grid");
  const gpu::Image& out = context.image(outName);
  const gpu::Image* from = &context.image("raw" + suffix);
  const gpu::Buffer* spreads[2] = {&grid, &grid};  // where nothing is smoothed, another buffer takes their bindings
  if (smooth_ > 0) {
    spreads[0] = &context.buffer("spread" + suffix);
    spreads[1] = &context.buffer("between_spread");
  }
  for (uint32_t pass = 0; pass <= smooth_; ++pass) {
    commands.barrier();
    // Ends in `out` whatever the number of passes.
    const gpu::Image& to = (smooth_ - pass) % 2 == 0 ? out : context.image("between" + suffix);
    commands.bind(suffix.empty() ? filter_ : lightFilter_,
                  {grid, context.image("position"), context.image("normal"), *from, to, *spreads[pass % 2], *spreads[1 - pass % 2]});
    struct {
      uint32_t width, height, pass, step, rays;
    } push{out.info().width, out.info().height, pass, pass == 0 ? 1u : kBlock << (pass - 1), rays_};
    commands.push(push);
    commands.dispatchItems(uint64_t{push.width} * push.height, 64);
    from = &to;
  }
}

}  // namespace radivox::clustered_voxel
