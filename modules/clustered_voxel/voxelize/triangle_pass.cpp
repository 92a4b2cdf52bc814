#include "modules/clustered_voxel/voxelize/triangle_pass.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {

constexpr uint32_t kGroup = 64;
constexpr uint32_t kRasterSide = 1024;  // raster_square.glsl; the largest resolution
constexpr size_t kMostBindings = 24;

struct ItemsPush {
  uint32_t triangleCount;
  uint32_t itemLimit;
};

ItemsPush itemsPush(uint64_t triangleCount) {
  constexpr uint64_t kMostItems = uint64_t{1} << 31;
  const uint64_t limit = std::clamp<uint64_t>(kMostItems / std::max<uint64_t>(triangleCount, 1), 1, 4096);
  return {static_cast<uint32_t>(triangleCount), static_cast<uint32_t>(limit)};
}

void requireFeature(bool present, std::string_view owner, const char* method, const char* feature) {
  if (present) return;
  throw Error(ErrorCode::Unsupported,
              std::string(owner) + ": method=" + method + " needs " + feature + ", which this device lacks; use method=auto");
}

}  // namespace

params::Param TrianglePass::methodParam(Method* method) {
  return params::choice("method", method, {"auto", "hardware", "geometry", "compute"},
                        "how columns are found: conservative rasterization, geometry shader, compute; same result",
                        params::Invalidates::Plan);
}

void TrianglePass::declare(graph::Declaration& d, Method method) {
  d.read("scene.vertices", "Vertex", useOf(method));
  d.read("scene.indices", "three a triangle", useOf(method));
  const Extent triangles = Extent::of("triangles");
  const bool compute = resolve(method) == Method::Compute;
  if (!compute) return;
  d.scratch("items", Shape::buffer(4, triangles + 2), "first item of each triangle, then the total");
  d.scratch("item_scan", Shape::buffer(4, Extent(gpu::Scan::scratchBytes(d.traits.triangleCount) / 4 + 1)), "scan of the items");
  d.scratch("item_arguments", Shape::buffer(4, 3), "groups of items", graph::UseCompute | graph::UseIndirect);
}

void TrianglePass::prepare(gpu::Device& device, Method method, std::string_view owner, std::string_view stage, uint32_t bindingCount,
                           const std::vector<gpu::SpecializationConstant>& constants) {
  assert(bindingCount <= kMostBindings);
  method_ = resolve(method);
  constexpr auto kB = BindingType::StorageBuffer;
  const std::string shader = "clustered_voxel/voxelize/" + std::string(stage);
  const std::vector<BindingType> bindings(bindingCount, kB);
  if (method_ == Method::Compute) {
    columns_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .shader = shader + ".comp", .bindings = bindings, .pushConstantBytes = sizeof(ItemsPush), .constants = constants});
    countItems_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/count_items.comp",
                                                                 .bindings = {kB, kB, kB, kB},
                                                                 .pushConstantBytes = sizeof(ItemsPush)});
    itemArguments_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/item_arguments.comp",
                                                                    .bindings = {kB, kB},
                                                                    .pushConstantBytes = sizeof(ItemsPush)});
    scan_ = std::make_unique<gpu::Scan>(device);
    return;
  }
  const gpu::Capabilities& can = device.capabilities();
  const bool hardware = method_ == Method::Hardware;
  if (hardware) requireFeature(can.conservativeRasterization, owner, "hardware", "VK_EXT_conservative_rasterization");
  if (!hardware) requireFeature(can.geometryShader, owner, "geometry", "geometry shaders");
  columns_ =
      gpu::Pipeline(device, gpu::RasterPipelineInfo{.vertexShader = hardware ? "clustered_voxel/voxelize/columns_hardware.vert"
                                                                             : "clustered_voxel/voxelize/columns_geometry.vert",
                                                    .geometryShader = hardware ? "" : "clustered_voxel/voxelize/columns_geometry.geom",
                                                    .fragmentShader = shader + ".frag",
                                                    .bindings = bindings,
                                                    .constants = constants,
                                                    .conservative = hardware});
}

void TrianglePass::record(graph::RecordContext& context, const gpu::Buffer& grid, std::span<const gpu::BoundResource> rest) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& vertices = context.buffer("scene.vertices");
  const gpu::Buffer& indices = context.buffer("scene.indices");
  const uint64_t triangleCount = context.count("triangles");
  if (triangleCount == 0) return;
  // A fixed array: recording allocates nothing.
  std::array<gpu::BoundResource, kMostBindings> all = {grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid,
                                                       grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid, grid};
  all[1] = vertices;
  all[2] = indices;
  std::copy(rest.begin(), rest.end(), all.begin() + 4);
  const std::span<const gpu::BoundResource> bound(all.data(), 4 + rest.size());
  if (method_ != Method::Compute) {
    commands.beginRendering({kRasterSide, kRasterSide}, {}, nullptr);
    commands.bind(columns_, bound);
    commands.draw(static_cast<uint32_t>(3 * triangleCount));
    commands.endRendering();
    return;
  }
  const gpu::Buffer& items = context.buffer("items");
  const gpu::Buffer& arguments = context.buffer("item_arguments");
  const ItemsPush push = itemsPush(triangleCount);
  commands.bind(countItems_, {grid, vertices, indices, items});
  commands.push(push);
  commands.dispatchItems(triangleCount, kGroup);
  scan_->scan(commands, items, items, triangleCount, context.buffer("item_scan"), &items, 4 * triangleCount);
  commands.bind(itemArguments_, {items, arguments});
  commands.push(push);
  commands.dispatch(1);
  commands.barrier();
  all[3] = items;
  commands.bind(columns_, bound);
  commands.push(push);
  commands.dispatchIndirect(arguments);
}

}  // namespace radivox::clustered_voxel
