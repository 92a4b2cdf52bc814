#include "modules/clustered_voxel/visibility/ray_bench.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"

namespace radivox::clustered_voxel {

namespace {

constexpr uint64_t kChunkRows = shared::kRowsPerChunk;

}  // namespace

RayBench::RayBench(gpu::Device& device, const graph::Executor& executor, const std::string& visibilityNode, const Settings& settings)
    : device_(device), executor_(executor), node_(visibilityNode), settings_(settings), pool_(device), timestamps_(device, 2) {
  const std::vector<std::byte> raw = gpu::download(device, *executor.findBuffer(node_ + ".grid"), 0, sizeof(grid_));
  std::memcpy(&grid_, raw.data(), sizeof(grid_));
  if (settings_.skip == 2 && executor.findGrown(node_ + ".clearance").empty()) settings_.skip = 1;

  // Rays take 32 bytes and a binding shows 128 MiB at least, so the rays of a chunk always fit.
  const uint64_t faces = executor.counts().at("faces");
  const uint64_t all = (faces + kChunkRows - 1) / kChunkRows;
  const uint64_t wanted =
      std::clamp<uint64_t>((settings.rays + kChunkRows * settings.raysPerFace / 2) / (kChunkRows * settings.raysPerFace), 1, all);
  for (uint64_t i = 0; i < wanted; ++i) {
    const uint64_t first = i * all / wanted * kChunkRows;
    const uint64_t rows = std::min(kChunkRows, faces - first);
    chunks_.push_back({static_cast<uint32_t>(first), static_cast<uint32_t>(rows), rayCount_});
    rayCount_ += rows * settings.raysPerFace;
  }
  std::vector<uint32_t> directions = makeDirections(settings.raysPerFace);
  directions.resize(shared::kShiftCount * shared::kMaxRays);
  directions_ = gpu::Buffer(device, "bench directions", directions.size() * sizeof(uint32_t));
  gpu::upload(device, directions_, directions);
  order_ = gpu::Buffer(device, "bench order", chunks_.size() * kChunkRows * sizeof(uint32_t));
  surfaceRays_ = gpu::Buffer(device, "bench rays", rayCount_ * sizeof(shared::BenchRay));
  liftedRays_ = gpu::Buffer(device, "bench lifted rays", rayCount_ * sizeof(shared::BenchRay));
  times_ = gpu::Buffer(device, "bench times", rayCount_ * sizeof(float));
  sortRows();
  measurePieces();
  submit(makePipeline(shared::kBenchRays), surfaceRays_);
  submit(makePipeline(shared::kBenchLifted), liftedRays_);
  for (uint32_t cast = 0; cast < std::size(casts_); ++cast) casts_[cast] = makePipeline(shared::kBenchTraversal + cast);
}

gpu::Pipeline RayBench::makePipeline(uint32_t task) const {
  std::vector<gpu::BindingType> bindings(23, gpu::BindingType::StorageBuffer);
  bindings[9] = gpu::BindingType::UniformBuffer;
  const uint32_t near = executor_.findGrown(node_ + ".triangle_ids").empty() ? 0 : 1;
  const uint32_t masked = near != 0 && settings_.alphaMasked ? 1 : 0;
  return {
      device_,
      gpu::ComputePipelineInfo{
          .shader = "clustered_voxel/visibility/bench.comp",
          .bindings = std::move(bindings),
          .pushConstantBytes = 24,
          .constants = {
              {0, settings_.skip}, {3, near}, {4, masked}, {5, task}, {6, executor_.findBuffer(node_ + ".corners") != nullptr ? 1u : 0u}}}};
}

void RayBench::sortRows() {
  const gpu::Buffer& faces = *executor_.findBuffer(node_ + ".faces");
  const gpu::Buffer* lists = executor_.findBuffer(node_ + ".triangle_first");
  const gpu::Pipeline sort(device_, gpu::ComputePipelineInfo{.shader = "clustered_voxel/visibility/sort_rows.comp",
                                                             .bindings = std::vector<gpu::BindingType>(4, gpu::BindingType::StorageBuffer),
                                                             .pushConstantBytes = 12,
                                                             .constants = {{0, lists != nullptr ? 1u : 0u}}});
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device_, handle, pool_);
    for (size_t i = 0; i < chunks_.size(); ++i) {
      constexpr VkDeviceSize kBytes = kChunkRows * sizeof(uint32_t);
      commands.bind(sort, {faces, {order_, i * kBytes, kBytes}, lists != nullptr ? *lists : faces, faces});
      commands.push(std::array{chunks_[i].firstFace, chunks_[i].rows, 0u});
      commands.dispatch(1);
    }
  });
  pool_.reset();
}

/// Visibility has freed its own.
void RayBench::measurePieces() {
  const std::vector<const gpu::Buffer*> ids = executor_.findGrown(node_ + ".triangle_ids");
  if (ids.empty()) return;
  const struct {
    uint32_t voxelCount, entryCount;
  } push{static_cast<uint32_t>(executor_.counts().at("voxels")), static_cast<uint32_t>(executor_.counts().at("triangle_entries"))};
  pieces_ = gpu::Buffer(device_, "bench pieces", uint64_t{push.entryCount} * 8);
  const gpu::Pipeline pipeline(device_,
                               gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/pieces.comp",
                                                        .bindings = std::vector<gpu::BindingType>(7, gpu::BindingType::StorageBuffer),
                                                        .pushConstantBytes = sizeof(push)});
  const auto buffer = [&](const char* port) -> const gpu::Buffer& { return *executor_.findBuffer(node_ + "." + port); };
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device_, handle, pool_);
    commands.bind(pipeline, {buffer("grid"), buffer("scene.vertices"), buffer("scene.indices"), buffer("voxels"), buffer("triangle_first"),
                             *ids.front(), pieces_});
    commands.push(push);
    commands.dispatchItems(push.entryCount, 64);
  });
  pool_.reset();
}

void RayBench::record(gpu::Commands& commands, const gpu::Pipeline& pipeline, const gpu::Buffer& rays) const {
  const gpu::Buffer& grid = *executor_.findBuffer(node_ + ".grid");
  const auto buffer = [&](const char* port) -> const gpu::Buffer& {
    const gpu::Buffer* found = executor_.findBuffer(node_ + "." + port);
    return found != nullptr ? *found : grid;  // never read then
  };
  const auto grown = [&](const char* port) -> const gpu::Buffer& {
    const std::vector<const gpu::Buffer*> found = executor_.findGrown(node_ + "." + port);
    return found.empty() ? grid : *found.front();
  };
  const gpu::Buffer* corners = executor_.findBuffer(node_ + ".corners");
  for (size_t i = 0; i < chunks_.size(); ++i) {
    const Chunk& chunk = chunks_[i];
    const uint64_t count = uint64_t{chunk.rows} * settings_.raysPerFace;
    constexpr VkDeviceSize kRay = sizeof(shared::BenchRay), kRowBytes = kChunkRows * sizeof(uint32_t);
    commands.bind(pipeline, {grid,
                             buffer("occupancy"),
                             buffer("rank"),
                             buffer("voxels"),
                             buffer("distance"),
                             grown("planes"),
                             buffer("first"),
                             buffer("faces"),
                             grown("clearance"),
                             directions_,
                             {order_, i * kRowBytes, kRowBytes},
                             {rays, chunk.firstRay * kRay, count * kRay},
                             buffer("plane_extras"),
                             buffer("triangle_first"),
                             grown("triangle_ids"),
                             buffer("scene.vertices"),
                             buffer("scene.indices"),
                             buffer("scene.triangle_materials"),
                             buffer("scene.materials"),
                             buffer("scene.textures"),
                             pieces_ ? pieces_ : grid,
                             corners != nullptr ? *corners : grid,
                             {times_, chunk.firstRay * sizeof(float), count * sizeof(float)}});
    struct {
      uint32_t firstFace, rowCount, rayCount;
      float nearDistance;
      uint32_t voxelCount;
      float triangles;
    } push{chunk.firstFace,    chunk.rows, settings_.raysPerFace, 0.f, static_cast<uint32_t>(executor_.counts().at("voxels")),
           settings_.triangles};
    commands.push(push);
    commands.dispatchItems((chunk.rows + uint64_t{63}) / 64 * 64 * settings_.raysPerFace, 64);
  }
}

double RayBench::submit(const gpu::Pipeline& pipeline, const gpu::Buffer& rays) {
  timestamps_.reset();
  const auto start = std::chrono::steady_clock::now();
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device_, handle, pool_);
    timestamps_.write(handle, 0);
    record(commands, pipeline, rays);
    timestamps_.write(handle, 1);
  });
  pool_.reset();
  if (timestamps_.isActive()) return timestamps_.readNs(0, 2)[1] * 1e-9;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<shared::BenchRay> RayBench::rays(Cast cast) const {
  return gpu::downloadAs<shared::BenchRay>(device_, cast == Cast::Traversal ? liftedRays_ : surfaceRays_, rayCount_);
}

double RayBench::run(Cast cast) {
  return submit(casts_[static_cast<uint32_t>(cast)], cast == Cast::Traversal ? liftedRays_ : surfaceRays_);
}

std::vector<float> RayBench::times() const { return gpu::downloadAs<float>(device_, times_, rayCount_); }

}  // namespace radivox::clustered_voxel
