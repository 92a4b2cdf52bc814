#include "modules/clustered_voxel/visibility/kept_hits.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::clustered_voxel {
namespace {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

constexpr size_t kTracePushBytes = 24;

shared::KeptHits layoutOf(const gpu::Buffer& buffer, uint64_t voxels, uint64_t faces) {
  const VkDeviceAddress address = buffer.address();
  return {
      {static_cast<uint32_t>(address), static_cast<uint32_t>(address >> 32)}, static_cast<uint32_t>(voxels), static_cast<uint32_t>(faces)};
}

/// The voxels of a brick that have changed, as a box.
struct Item {
  glm::vec3 least, greatest;
};

using Items = std::vector<Item>;

shared::ChangedBox boxAround(const Items& items) {
  shared::ChangedBox box{items.front().least, items.front().greatest};
  for (const Item& item : items) {
    box.least = glm::min(box.least, item.least);
    box.greatest = glm::max(box.greatest, item.greatest);
  }
  return box;
}

/// In proportion to how many rays meet the box with its margin.
float surfaceOf(const Items& items) {
  const shared::ChangedBox box = boxAround(items);
  const glm::vec3 e = box.greatest - box.least + 1.f + 2.f * shared::kChangedMargin;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// In two at the middle of the longest side; the second may be empty.
std::pair<Items, Items> split(const Items& items) {
  const shared::ChangedBox box = boxAround(items);
  const glm::vec3 e = box.greatest - box.least;
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const float middle = 0.5f * (box.least[axis] + box.greatest[axis]);
  std::pair<Items, Items> halves;
  for (const Item& item : items) (0.5f * (item.least[axis] + item.greatest[axis]) < middle ? halves.first : halves.second).push_back(item);
  if (halves.first.empty()) std::swap(halves.first, halves.second);
  return halves;
}

}  // namespace

std::vector<shared::ChangedBox> wrapChanges(const shared::Grid& grid, std::span<const uint32_t> changed) {
  Items all;
  for (uint32_t brick = 0; brick < grid.brickCount; ++brick) {
    const glm::uvec2 word(changed[2 * brick], changed[2 * brick + 1]);
    if (word.x == 0 && word.y == 0) continue;
    glm::uvec3 least(3), greatest(0);
    for (uint32_t bit = 0; bit < 64; ++bit) {
      if (!shared::hasBit(word, bit)) continue;
      least = glm::min(least, shared::bitCoordinate(bit));
      greatest = glm::max(greatest, shared::bitCoordinate(bit));
    }
    const glm::uvec3 corner = 4u * shared::brickCoordinate(brick, grid.bricks);
    all.push_back({glm::vec3(corner + least), glm::vec3(corner + greatest)});
  }
  if (all.empty()) return {};
  // Those halves come apart first that save most.
  std::vector<Items> groups{std::move(all)};
  while (groups.size() < shared::kMostChangedBoxes) {
    size_t best = 0;
    float most = 0;
    std::pair<Items, Items> halves;
    for (size_t g = 0; g < groups.size(); ++g) {
      std::pair<Items, Items> parts = split(groups[g]);
      if (parts.second.empty()) continue;
      const float saved = surfaceOf(groups[g]) - surfaceOf(parts.first) - surfaceOf(parts.second);
      if (saved <= most) continue;
      best = g;
      most = saved;
      halves = std::move(parts);
    }
    if (most <= 0) break;
    groups[best] = std::move(halves.first);
    groups.push_back(std::move(halves.second));
  }
  std::vector<shared::ChangedBox> boxes;
  for (const Items& group : groups) boxes.push_back(boxAround(group));
  return boxes;
}

void KeptHits::declare(graph::Declaration& d, uint32_t rays) {
  const uint64_t rows = shared::kRowsPerChunk;
  for (const char* port : {"kept_even", "kept_odd"})
    d.write(port, {}, "what rays hit, and the voxels: one of the two, by turns").growable = true;
  d.scratch("old_faces", Shape::buffer(4, Extent::of("faces")), "of each face in the run before");
  d.scratch("changed", Shape::buffer(8, Extent::of("bricks")), "bit per voxel");
  d.scratch("boxes", Shape::buffer(sizeof(shared::ChangedBox), shared::kMostChangedBoxes), "around what has changed");
  d.scratch("todo", Shape::buffer(4, rows * shared::rayWords(rays)), "rays to trace, a bit each");
  d.scratch("traced_count", Shape::buffer(4, 1), "rays traced");
}

void KeptHits::prepare(graph::PrepareContext& context, uint32_t rays, gpu::Pipeline reuse) {
  rays_ = rays;
  reuse_ = std::move(reuse);
  grid_.reset();
  const auto make = [&](const char* shader, size_t bindings, uint32_t pushBytes, std::vector<gpu::SpecializationConstant> constants) {
    return gpu::Pipeline(context.device(),
                         gpu::ComputePipelineInfo{.shader = shader,
                                                  .bindings = std::vector<BindingType>(bindings, BindingType::StorageBuffer),
                                                  .pushConstantBytes = pushBytes,
                                                  .constants = std::move(constants)});
  };
  voxels_ = make("clustered_voxel/visibility/keep_voxels.comp", 10, sizeof(shared::KeptHits), {{0, context.has("triangle_ids") ? 1u : 0u}});
  changes_ = make("clustered_voxel/visibility/find_changes.comp", 4, 2 * sizeof(shared::KeptHits), {});
  match_ = make("clustered_voxel/visibility/match_faces.comp", 6, sizeof(shared::KeptHits), {});
}

const gpu::Buffer& KeptHits::now(graph::RecordContext& context) const { return *context.grown(odd_ ? "kept_odd" : "kept_even").at(0); }

void KeptHits::begin(graph::RecordContext& context, const shared::Grid& grid) {
  const auto same = [&](const char* port) { return !context.has(port) || !context.changed(port); };
  const uint64_t voxels = context.count("voxels"), faces = context.count("faces");
  reuses_ = grid_ && faces > 0 && !context.firstRun() && std::memcmp(&*grid_, &grid, sizeof(grid)) == 0 && same("scene.materials") &&
            same("scene.textures");
  old_ = now_;
  if (!reuses_) context.clearGrown(odd_ ? "kept_odd" : "kept_even");
  grid_.reset();  // until the run has ended well
  newGrid_ = grid;
  odd_ = !odd_;
  context.clearGrown(odd_ ? "kept_odd" : "kept_even");
  if (faces == 0) return;
  now_ = layoutOf(context.grow(odd_ ? "kept_odd" : "kept_even", 4 * (3 * voxels + faces * (1 + uint64_t{rays_}))), voxels, faces);
}

void KeptHits::recordVoxels(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& none = context.buffer("grid");
  const bool triangles = context.has("triangle_ids");
  const auto near = [&](const char* port) -> const gpu::Buffer& { return triangles ? context.buffer(port) : none; };
  const std::vector<const gpu::Buffer*> ids = triangles ? context.grown("triangle_ids") : std::vector<const gpu::Buffer*>{};
  commands.bind(voxels_, {context.buffer("voxels"), *context.grown("planes").at(0), context.buffer("plane_extras"), context.buffer("first"),
                          context.buffer("faces"), near("triangle_first"), ids.empty() ? none : *ids.front(), near("scene.vertices"),
                          near("scene.indices"), near("scene.triangle_materials")});
  commands.push(now_);
  commands.dispatchItems(now_.voxelCount, 64);
  if (!reuses_) return;
  commands.copy(context.buffer("occupancy"), context.buffer("changed"), context.count("bricks") * 8);
  commands.fill(context.buffer("old_faces"), shared::kNone);
  commands.fill(context.buffer("traced_count"), 0);
  commands.barrier();
  const struct { shared::KeptHits old, now; } push{old_, now_};
  commands.bind(changes_, {context.buffer("grid"), context.buffer("occupancy"), context.buffer("rank"), context.buffer("changed")});
  commands.push(push);
  commands.dispatchItems(old_.voxelCount, 64);
  commands.bind(match_, {context.buffer("grid"), context.buffer("occupancy"), context.buffer("rank"), context.buffer("mask"),
                         context.buffer("first"), context.buffer("old_faces")});
  commands.push(old_);
  commands.dispatchItems(old_.faceCount, 64);
}

void KeptHits::readChanges(graph::RecordContext& context) {
  if (!reuses_) return;
  const std::vector<std::byte> raw = context.readBuffer("changed", 0, context.count("bricks") * 8);
  std::vector<uint32_t> changed(raw.size() / 4);
  std::memcpy(changed.data(), raw.data(), raw.size());
  boxes_ = wrapChanges(newGrid_, changed);
  uint64_t count = 0;
  for (const uint32_t word : changed) count += static_cast<uint64_t>(std::popcount(word));
  context.reportStat("changed_voxels", static_cast<double>(count));
}

void KeptHits::recordReuse(graph::RecordContext& context, std::vector<gpu::BoundResource> trace, const void* push, uint32_t rows) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& boxes = context.buffer("boxes");
  if (!boxes_.empty()) commands.update(boxes, boxes_.data(), boxes_.size() * sizeof(shared::ChangedBox));
  commands.barrier();
  for (const char* port : {"todo", "old_faces", "boxes", "traced_count"}) trace.push_back(context.buffer(port));
  struct {
    std::array<std::byte, kTracePushBytes> trace;
    shared::KeptHits old;
    uint32_t boxCount;
  } constants{{}, old_, static_cast<uint32_t>(boxes_.size())};
  std::memcpy(constants.trace.data(), push, kTracePushBytes);
  commands.bind(reuse_, trace);
  commands.push(constants);
  commands.dispatchItems(uint64_t{rows} * shared::rayWords(rays_), 64);
  commands.barrier();
}

void KeptHits::recordHits(graph::RecordContext& context, uint32_t firstFace, uint32_t rows) {
  context.commands().copy(context.buffer("hits"), now(context), uint64_t{rows} * rays_ * 4, 0,
                          4 * (uint64_t{3} * now_.voxelCount + now_.faceCount + uint64_t{firstFace} * rays_));
}

void KeptHits::end(graph::RecordContext& context) {
  context.clearGrown(odd_ ? "kept_even" : "kept_odd");
  if (context.count("faces") == 0) return;
  if (reuses_) {
    uint32_t traced = 0;
    const std::vector<std::byte> raw = context.readBuffer("traced_count", 0, sizeof(traced));
    std::memcpy(&traced, raw.data(), sizeof(traced));
    context.reportStat("traced_rays", traced);
  }
  grid_ = newGrid_;
}

}  // namespace radivox::clustered_voxel
