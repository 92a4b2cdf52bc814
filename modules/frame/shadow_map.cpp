#include "modules/frame/shadow_map.h"

#include <cassert>

#include "shaders/shared/scene.h"

namespace radivox::frame {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kRaster = graph::UseRaster;
constexpr uint32_t kImageUse = graph::UseAttachment | graph::UseCompute | graph::UseTransfer;
}  // namespace

ShadowMap::ShadowMap()
    : table_({params::choice("sides", &sides_, {"both", "gltf"},
                             "both: every surface casts shadows; gltf: back faces of single-sided materials cast none",
                             params::Invalidates::Plan)}) {}

void ShadowMap::declare(graph::Declaration& d) {
  const bool sampledEmitters = d.traits.hasEmitters() && !d.traits.emittersByRays;
  if (!d.traits.hasPunctualLights() && !sampledEmitters) {
    d.leaveOut("no light casts shadows from a point or along a direction");
    return;
  }
  d.read("scene.vertices", "Vertex", kRaster);
  d.read("scene.indices", "3 a triangle", kRaster);
  d.read("scene.triangle_materials", "material of each triangle", kRaster);
  d.read("scene.materials", "Material", kRaster);
  d.read("scene.textures", "Texture", kRaster);
  d.read("scene.shadow_views", "ShadowView", kRaster | graph::UseHost);
  const Extent side = Extent::of("shadow_resolution");
  const Extent layers = Extent::of("shadow_layers");
  d.write("depth", Shape::image(VK_FORMAT_D32_SFLOAT, side, side, layers, true), "nearest surface from each light, reversed z; 0: none",
          kImageUse);
  d.write("triangle", Shape::image(VK_FORMAT_R32_UINT, side, side, layers, true), "id + 1 of that surface; 0: none", kImageUse);
}

void ShadowMap::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  pipeline_ = gpu::Pipeline(context.device(),
                            gpu::RasterPipelineInfo{.vertexShader = "frame/shadow_map.vert",
                                                    .fragmentShader = "frame/shadow_map.frag",
                                                    .bindings = {kB, kB, kB, kB, kB, kB},
                                                    .pushConstantBytes = sizeof(uint32_t),
                                                    .constants = {{0, context.traits().hasAlphaMasks()},
                                                                  {1, context.traits().hasSingleSides() && sides_ == Sides::Gltf}},
                                                    .colorFormats = {VK_FORMAT_R32_UINT},
                                                    .depthFormat = VK_FORMAT_D32_SFLOAT});
}

void ShadowMap::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& viewBuffer = context.buffer("scene.shadow_views");
  gpu::Image& depth = context.image("depth");
  gpu::Image& triangle = context.image("triangle");
  const auto viewCount = static_cast<uint32_t>(context.count("shadow_views"));
  const auto vertexCount = static_cast<uint32_t>(3 * context.count("triangles"));
  const auto* views = static_cast<const shared::ShadowView*>(viewBuffer.mapped());
  assert((views != nullptr || viewCount == 0) && "scene.shadow_views must be host visible");

  const VkExtent2D extent{depth.info().width, depth.info().height};
  uint32_t texelCount = 0, drawn = 0;
  for (uint32_t layer = 0; layer < depth.info().layers; ++layer) {
    const gpu::Commands::Attachment color[] = {{&triangle, layer, true, {}}};
    const gpu::Commands::Attachment far{&depth, layer, true, {}};
    commands.beginRendering(extent, color, &far);
    commands.bind(pipeline_, {context.buffer("scene.vertices"), context.buffer("scene.indices"), context.buffer("scene.triangle_materials"),
                              context.buffer("scene.materials"), context.buffer("scene.textures"), viewBuffer});
    for (uint32_t view = 0; view < viewCount; ++view) {
      const uint32_t side = views[view].resolution;
      if (views[view].layer != layer || side == 0) continue;
      ++drawn;
      texelCount += side * side;
      commands.setViewport(static_cast<int32_t>(views[view].offsetX), static_cast<int32_t>(views[view].offsetY), side, side);
      commands.push(view);
      commands.draw(vertexCount);
    }
    commands.endRendering();
  }
  context.reportStat("views", drawn);
  context.reportStat("texels", texelCount);
}

}  // namespace radivox::frame
