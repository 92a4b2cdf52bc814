#include "modules/clustered_voxel/voxelize/triangles.h"

#include <array>

#include "shaders/shared/listed_triangle.h"
#include "shaders/shared/triangle_corners.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;

namespace {
const char* piecesPort(const graph::RecordContext& context) { return context.has("pieces") ? "pieces" : "own_pieces"; }
}  // namespace

graph::Port& readCorners(graph::Declaration& d, bool wanted, const std::string& unwanted) {
  const auto within = [](uint64_t amount, uint64_t limit) { return limit == 0 || amount <= limit; };  // 0: no device is known
  const uint64_t bytes = uint64_t{d.traits.triangleCount} * shared::kCornerBytes;
  const bool fits = within(bytes, d.capabilities.maxStorageBufferRange) && within(bytes / 16, d.capabilities.maxTexelBufferElements);
  return d.readIf(wanted && fits, "corners", "corners of triangles", unwanted + ", or there are too many triangles for one buffer");
}

Triangles::Triangles()
    : table_({TrianglePass::methodParam(&method_),
              params::number("most", &most_, {1, 4096}, "voxels met by more triangles have no list", params::Invalidates::Rerun),
              params::flag("apart", &apart_,
                           "of a voxel face, surface on the far side of its largest piece is no part: else light comes through the corners "
                           "of thin walls",
                           params::Invalidates::Plan)}) {}

void Triangles::declare(graph::Declaration& d) {
  const uint32_t use = TrianglePass::useOf(method_);
  if (d.traits.triangleCount > shared::kMostListedTriangles)
    throw Error(ErrorCode::Unsupported,
                "clustered_voxel.triangles: " + std::to_string(d.traits.triangleCount) + " triangles; lists hold up to " +
                    std::to_string(shared::kMostListedTriangles) +
                    ": set visibility.triangles=0, gather_pixels.near=0, and connect no triangles to surface and inject");
  TrianglePass::declare(d, method_);
  d.read("scene.triangle_materials", "one a triangle");
  d.read("scene.materials", "Material");
  d.read("grid", "Grid", use);
  d.read("occupancy", "two words a brick", use);
  d.read("rank", "occupied voxels before the brick", use);
  d.read("voxels", "packed coordinate of each voxel");
  const Extent voxels = Extent::of("voxels");
  d.write("first", Shape::buffer(4, voxels + 1), "triangles in the lists of the voxels before, then the total", use | graph::UseTransfer);
  d.write("ids", Shape::buffer(4, Extent::of("triangle_entries")),
          "triangles, ascending within a voxel, and which faces they are no part of (shared/listed_triangle.h)")
      .growable = true;
  graph::Port& pieces = d.write("pieces", Shape::buffer(8, Extent::of("triangle_entries")),
                                "middle of each triangle in its voxel (unorm 10:10:10), its area there (float bits, h²)");
  pieces.growable = pieces.optional = true;
  if (apart_) d.write("own_pieces", {}, "the same where nobody reads them; freed at once").growable = true;
  // One more: the last of an odd number ends in the middle of a texel.
  d.write("corners", Shape::buffer(shared::kCornerBytes, Extent::of("triangles") + 1),
          "corners of each triangle (grid space): shared/triangle_corners.h")
      .optional = true;
  d.publishCount("triangle_entries", "", 0);
  d.scratch("next", Shape::buffer(4, voxels + 1), "triangles met, then the next free place of each voxel", use | graph::UseTransfer);
  d.scratch("total", Shape::buffer(4, 2), "entries, low and high word");
  d.scratch("scan", Shape::buffer(4, voxels / 256 + 4096), "scan of the lists");
  d.hostPaced();
}

void Triangles::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = gpu::BindingType::StorageBuffer;
  count_.prepare(device, method_, kType, "triangles", 9, {{0, 0}});
  fill_.prepare(device, method_, kType, "triangles", 9, {{0, 1}});
  limit_ = gpu::Pipeline(
      device,
      gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/limit_triangles.comp", .bindings = {kB, kB}, .pushConstantBytes = 8});
  sort_ = gpu::Pipeline(
      device,
      gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/sort_triangles.comp", .bindings = {kB, kB}, .pushConstantBytes = 4});
  hasPieces_ = context.has("pieces") || apart_;
  if (hasPieces_)
    pieces_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .shader = "clustered_voxel/voxelize/pieces.comp", .bindings = {kB, kB, kB, kB, kB, kB, kB}, .pushConstantBytes = 8});
  if (apart_)
    partSides_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/part_sides.comp",
                                                                .bindings = {kB, kB, kB, kB, kB, kB, kB, kB, kB},
                                                                .pushConstantBytes = 4});
  if (context.has("corners"))
    corners_ = gpu::Pipeline(
        device,
        gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/corners.comp", .bindings = {kB, kB, kB, kB}, .pushConstantBytes = 4});
  scan_ = std::make_unique<gpu::Scan>(device);
}

void Triangles::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto voxelCount = static_cast<uint32_t>(context.count("voxels"));
  const gpu::Buffer& first = context.buffer("first");
  const gpu::Buffer& next = context.buffer("next");
  const bool isCount = context.step() == 0;
  if (!isCount && context.grown("ids").empty()) return;
  if (isCount)
    commands.fill(next, 0);
  else
    commands.copy(first, next, 4 * (uint64_t{voxelCount} + 1));
  commands.barrier();
  const std::array<gpu::BoundResource, 5> rest = {context.buffer("occupancy"), context.buffer("rank"), first, next,
                                                  isCount ? next : *context.grown("ids").front()};
  (isCount ? count_ : fill_).record(context, context.buffer("grid"), rest);
  commands.barrier();
  if (isCount) {
    if (context.has("corners")) {
      const auto triangles = static_cast<uint32_t>(context.count("triangles"));
      commands.bind(corners_,
                    {context.buffer("grid"), context.buffer("scene.vertices"), context.buffer("scene.indices"), context.buffer("corners")});
      commands.push(triangles);
      commands.dispatchItems(triangles, 64);
    }
    commands.bind(limit_, {next, first});
    const struct { uint32_t voxelCount, most; } push{voxelCount, most_};
    commands.push(push);
    commands.dispatchItems(uint64_t{voxelCount} + 1, 64);
    scan_->scan(commands, first, first, uint64_t{voxelCount} + 1, context.buffer("scan"), &context.buffer("total"));
  } else {
    commands.bind(sort_, {first, *context.grown("ids").front()});
    commands.push(voxelCount);
    commands.dispatchItems(voxelCount, 64);
    const gpu::Buffer* pieces = hasPieces_ ? context.grown(piecesPort(context)).front() : nullptr;
    if (hasPieces_) {
      commands.barrier();
      commands.bind(pieces_, {context.buffer("grid"), context.buffer("scene.vertices"), context.buffer("scene.indices"),
                              context.buffer("voxels"), first, *context.grown("ids").front(), *pieces});
      const struct { uint32_t voxelCount, entryCount; } push{voxelCount, static_cast<uint32_t>(context.count("triangle_entries"))};
      commands.push(push);
      commands.dispatchItems(push.entryCount, 64);
    }
    if (apart_) {
      commands.barrier();
      commands.bind(partSides_, {context.buffer("scene.vertices"), context.buffer("scene.indices"),
                                 context.buffer("scene.triangle_materials"), context.buffer("scene.materials"), first,
                                 *context.grown("ids").front(), *pieces, context.buffer("grid"), context.buffer("voxels")});
      commands.push(voxelCount);
      commands.dispatchItems(voxelCount, 64);
    }
  }
}

void Triangles::stepDone(graph::RecordContext& context) {
  if (context.step() != 0) {
    if (hasPieces_ && !context.has("pieces")) context.clearGrown("own_pieces");
    return;
  }
  uint32_t total[2];
  const std::vector<std::byte> words = context.readBuffer("total", 0, sizeof(total));
  std::memcpy(total, words.data(), sizeof(total));
  if (total[1] != 0)
    throw Error(ErrorCode::OutOfMemory,
                "clustered_voxel.triangles: more than 2^32 triangles in voxels; lower triangles.most or voxelize.resolution");
  context.clearGrown("ids");
  if (hasPieces_) context.clearGrown(piecesPort(context));
  if (total[0] > 0) context.grow("ids", uint64_t{total[0]} * 4);
  if (total[0] > 0 && hasPieces_) context.grow(piecesPort(context), uint64_t{total[0]} * 8);
  context.setCount("triangle_entries", total[0]);
}

}  // namespace radivox::clustered_voxel
