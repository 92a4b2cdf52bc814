#include "modules/clustered_voxel/inspect/inspect.h"

#include "modules/clustered_voxel/structure.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

void Inspect::declare(graph::Declaration& d) {
  d.read("position", "relative world m, w: distance along the view axis, 0: sky");
  d.read("normal", "unit shading normal");
  declareStructure(d);
  d.read("labels", "cluster of each face");
  const Shape image = Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height"));
  d.write("face", image, "face id + 1, voxel index, direction, area in h²").optional = true;
  d.write("cluster", image, "a colour per cluster; a: cluster id + 1").optional = true;
}

void Inspect::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  const auto make = [&](uint32_t what) {
    return gpu::Pipeline(context.device(), gpu::ComputePipelineInfo{.shader = "clustered_voxel/inspect/inspect.comp",
                                                                    .bindings = {kB, kB, kB, kB, kB, kB, kI, kI, kB, kI},
                                                                    .pushConstantBytes = 8,
                                                                    .constants = {{0, what}}});
  };
  if (context.has("face")) face_ = make(0);
  if (context.has("cluster")) cluster_ = make(1);
}

void Inspect::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  for (const char* port : {"face", "cluster"}) {
    if (!context.has(port)) continue;
    const gpu::Image& out = context.image(port);
    const gpu::Pipeline& pipeline = std::string_view(port) == "face" ? face_ : cluster_;
    struct {
      uint32_t width, height;
    } push{out.info().width, out.info().height};
    bindStructure(context, pipeline, {context.image("position"), context.image("normal"), context.buffer("labels"), out});
    commands.push(push);
    commands.dispatchItems(uint64_t{push.width} * push.height, 64);
  }
}

}  // namespace radivox::clustered_voxel
