#include "modules/frame/gbuffer.h"

namespace radivox::frame {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kRaster = graph::UseRaster;
constexpr uint32_t kImageUse = graph::UseAttachment | graph::UseCompute | graph::UseTransfer;
constexpr VkFormat kFloat4 = VK_FORMAT_R32G32B32A32_SFLOAT;
}  // namespace

GBuffer::GBuffer()
    : table_({params::choice("sides", &sides_, {"both", "gltf"},
                             "both: every surface is seen from both sides; gltf: back faces of single-sided materials are not there",
                             params::Invalidates::Plan)}) {}

void GBuffer::declare(graph::Declaration& d) {
  d.read("scene.vertices", "Vertex", kRaster);
  d.read("scene.indices", "3 a triangle", kRaster);
  d.read("scene.triangle_materials", "material of each triangle", kRaster);
  d.read("scene.materials", "Material", kRaster);
  d.read("scene.textures", "Texture", kRaster);
  d.read("view.camera", "Camera", kRaster);
  const Extent width = Extent::of("width");
  const Extent height = Extent::of("height");
  const Shape color = Shape::image(kFloat4, width, height);
  d.write("position", color, "relative world m; w: distance along the view axis, 0: sky", kImageUse);
  d.write("normal", color, "unit shading normal on the viewer's side; w = 0", kImageUse);
  d.write("albedo", color, "ρ; a: 1 surface, 0 sky", kImageUse);
  d.write("emission", color, "L_e towards the viewer, W/(m² sr)", kImageUse);
  d.write("triangle", Shape::image(VK_FORMAT_R32_UINT, width, height), "id + 1; 0: sky", kImageUse);
  d.scratch("depth", Shape::image(VK_FORMAT_D32_SFLOAT, width, height), "reversed z", graph::UseAttachment);
}

void GBuffer::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  const scene::Traits& traits = context.traits();
  pipeline_ = gpu::Pipeline(
      context.device(),
      gpu::RasterPipelineInfo{
          .vertexShader = "frame/gbuffer.vert",
          .fragmentShader = "frame/gbuffer.frag",
          .bindings = {kB, kB, kB, kB, kB, kB},
          .constants = {{0, traits.hasAlphaMasks()}, {1, traits.hasSingleSides() && sides_ == Sides::Gltf}, {2, traits.hasTextures()}},
          .colorFormats = {kFloat4, kFloat4, kFloat4, kFloat4, VK_FORMAT_R32_UINT},
          .depthFormat = VK_FORMAT_D32_SFLOAT});
}

void GBuffer::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  gpu::Image& position = context.image("position");
  const gpu::Commands::Attachment color[] = {{&position, 0, true, {}},
                                             {&context.image("normal"), 0, true, {}},
                                             {&context.image("albedo"), 0, true, {}},
                                             {&context.image("emission"), 0, true, {}},
                                             {&context.image("triangle"), 0, true, {}}};
  const gpu::Commands::Attachment far{&context.image("depth"), 0, true, {}};
  commands.beginRendering({position.info().width, position.info().height}, color, &far);
  commands.bind(pipeline_, {context.buffer("scene.vertices"), context.buffer("scene.indices"), context.buffer("scene.triangle_materials"),
                            context.buffer("scene.materials"), context.buffer("scene.textures"), context.buffer("view.camera")});
  commands.draw(static_cast<uint32_t>(3 * context.count("triangles")));
  commands.endRendering();
}

}  // namespace radivox::frame
