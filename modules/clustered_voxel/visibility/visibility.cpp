#include "modules/clustered_voxel/visibility/visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "modules/clustered_voxel/visibility/directions.h"
#include "modules/clustered_voxel/voxelize/triangles.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/clearance.h"
#include "shaders/shared/visibility_row.h"

namespace radivox::clustered_voxel {
namespace {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;
using shared::kRowsPerChunk;

constexpr size_t kTraceBindings = 23, kReuseBindings = 26;
constexpr size_t kDirectionsBinding = 9;
constexpr uint32_t kTracePushBytes = 24;

uint32_t tableBits(uint32_t rayCount) { return static_cast<uint32_t>(std::bit_width(std::bit_ceil(rayCount))); }

uint64_t clearanceBytes(const shared::Grid& grid) {
  const glm::u64vec3 size(grid.size);
  return 4 * ((size.x + 1) * ((size.y + 1) * (size.z + 2) + 1) + 1);  // clearanceIndex() of the last rim voxel, and one
}
/// Voxels of the grid with its rim.
uint64_t rimmedVoxels(const shared::Grid& grid) { return uint64_t{grid.size.x + 2} * (grid.size.y + 2) * (grid.size.z + 2); }

}  // namespace

Visibility::Visibility()
    : table_(
          {params::swept(params::number("rays", &rays_, {1, shared::kMaxRays}, "rays per voxel face", params::Invalidates::Plan),
                         {"16", "32", "64", "128", "256"}, "256"),
           params::choice("traversal", &traversal_, {"dda", "bresenham"},
                          "dda: every voxel a ray touches; bresenham: the paper's 26-connected line, which stops at any voxel",
                          params::Invalidates::Plan),
           params::choice("frame", &frame_, {"normal", "axis"},
                          "normal: the hemisphere about the face's surface; axis: the paper's, about the face's axis from the voxel's side",
                          params::Invalidates::Plan),
           params::choice("hit", &hit_, {"plane", "voxel"},
                          "plane: a ray stops where it crosses the mean plane of a voxel's surface; voxel: at any voxel with faces",
                          params::Invalidates::Plan),
           params::choice("skip", &skip_, {"clearance", "bricks", "none"},
                          "how rays pass empty space (same result): a box a voxel, 4 B; a byte a brick; or voxel by voxel",
                          params::Invalidates::Plan),
           params::number("triangles", &triangles_, {0.0, 4096.0}, "rays test triangles up to this distance, voxels",
                          params::Invalidates::Plan),
           params::choice("weights", &weights_, {"seen", "area"},
                          "what a face counts for in its cluster's means: how much of it other faces see, or its area",
                          params::Invalidates::Plan),
           params::swept(
               params::number("near", &near_, {0.0, 4096.0}, "hits up to this distance keep their face instead of its cluster, voxels",
                              params::Invalidates::Rerun),
               {"0", "4", "8", "16"}, "4096"),
           params::flag(
               "keep", &keep_,
               "keep what each ray hit, 4 B a ray: after a move only rays that pass what has changed are traced again, to the same result",
               params::Invalidates::Plan)}) {}

void Visibility::declare(graph::Declaration& d) {
  d.read("grid", "Grid");
  d.read("occupancy", "two words a brick");
  d.read("rank", "occupied voxels before the brick");
  d.read("voxels", "packed coordinate of each voxel");
  d.read("distance", "bricks to the nearest occupied brick, a byte a brick");
  d.read("mask", "faces of each voxel; planes hold them too").frees = true;
  d.read("first", "first face of each voxel");
  d.read("faces", "Face");
  d.read("labels", "cluster of each face");
  const auto leaveOut = [this](graph::Port& port) {
    port.optional = true;
    port.unwanted = triangles_ == 0.f;
    port.unwantedReason = "visibility.triangles=0";
  };
  for (const char* name : {"triangle_first", "triangle_ids", "scene.vertices", "scene.indices", "scene.triangle_materials",
                           "scene.materials", "scene.textures"})
    leaveOut(d.read(name, "triangles of each voxel"));
  leaveOut(d.modify("pieces", "where rays start on the triangles of each voxel; freed once all are traced"));
  readCorners(d, triangles_ > 0.f, "visibility.triangles=0");
  const Extent faces = Extent::of("faces");
  d.write("row_start", Shape::buffer(4, faces * (kRowsPerChunk + 1) / kRowsPerChunk + (kRowsPerChunk + 1)),
          "first bit of each row within its chunk");
  d.write("chunk_table", Shape::buffer(8, faces / kRowsPerChunk + 1), "device address of each chunk of entries");
  d.write("entries", {}, "clusters and faces that rays met, and how many did: shared/visibility_row.h").growable = true;
  d.write("clearance", {}, "u32 per voxel and rim: the empty box around it, shared/clearance.h").growable = true;
  d.write("clearance_work", {}, "between two passes; freed at once").growable = true;
  d.write("planes", {}, "what rays are stopped by: shared/voxel_plane.h").growable = true;
  d.write("plane_extras", Shape::buffer(4, Extent::of("voxels")), "where the planes of a voxel after its first are");
  d.write("weights", Shape::buffer(4, faces), "how much of each face others see");
  d.publishCount("entries", "", 0);
  d.hostPaced();
  const uint64_t rows = kRowsPerChunk;
  if (keep_) KeptHits::declare(d, rays_);
  d.scratch("order", Shape::buffer(4, rows + 1), "rows as lanes take them, and how many of them are traced");
  d.scratch("hits", Shape::buffer(4, rows * rays_), "what each ray of the chunk hit");
  d.scratch("table", Shape::buffer(4, rows << tableBits(rays_)), "hash table a row");
  d.scratch("offsets", Shape::buffer(4, rows + 1), "bits a row, then their exclusive sums");
  d.scratch("total", Shape::buffer(4, 2), "bits of the chunk; planes beyond the first of their voxels");
  d.scratch("entry_count", Shape::buffer(4, 1), "entries of all chunks so far");
  // Scan::scratchBytes is a word a block, on every level.
  d.scratch("plane_scan", Shape::buffer(4, Extent::of("voxels") / 512 + 1024), "scan");
  d.scratch("scan", Shape::buffer(1, gpu::Scan::scratchBytes(rows + 1)), "scan");
}

void Visibility::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = BindingType::StorageBuffer;
  // Clearance is written as a storage buffer and read as texels, words.
  const gpu::Capabilities& can = device.capabilities();
  maxRange_ = std::min<VkDeviceSize>(can.maxStorageBufferRange, uint64_t{4} * can.maxTexelBufferElements);
  scan_ = std::make_unique<gpu::Scan>(device);
  const auto make = [&](std::string_view shader, size_t bindings, uint32_t pushBytes, std::vector<gpu::SpecializationConstant> constants) {
    std::vector<BindingType> types(bindings, kB);
    if (bindings >= kTraceBindings) types[kDirectionsBinding] = BindingType::UniformBuffer;
    return gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .shader = shader, .bindings = std::move(types), .pushConstantBytes = pushBytes, .constants = std::move(constants)});
  };
  countPlanes_ = make("clustered_voxel/visibility/planes.comp", 5, 4, {{0, 1}});
  planes_ = make("clustered_voxel/visibility/planes.comp", 5, 4, {{0, 0}});
  const uint32_t lists = context.has("triangle_ids") ? 1 : 0;
  sortRows_ = make("clustered_voxel/visibility/sort_rows.comp", 4, 12, {{0, lists}});
  if (keep_) sortSome_ = make("clustered_voxel/visibility/sort_rows.comp", 4, 12, {{0, lists}, {1, 1}});
  merge_ = make("clustered_voxel/visibility/merge.comp", 7, 24, {{0, weights_ == Weights::Seen ? 1u : 0u}, {1, rays_ <= 16 ? 1u : 0u}});
  fill_ = make("clustered_voxel/visibility/fill.comp", 4, 16, {});
  const auto frame = static_cast<uint32_t>(frame_), hit = static_cast<uint32_t>(hit_);
  const uint32_t near = lists;
  const uint32_t corners = context.has("corners") ? 1 : 0;
  const uint32_t masked = near != 0 && context.traits().alphaMasked ? 1 : 0;
  const uint32_t skyImage = context.traits().skyImage ? 1 : 0;
  const auto makeTrace = [&](Skip skip, uint32_t someRays) {
    if (traversal_ == Traversal::Bresenham)
      return make("clustered_voxel/visibility/trace_bresenham.comp", kTraceBindings, kTracePushBytes,
                  {{2, frame}, {7, skyImage}, {8, someRays}});
    return make(
        "clustered_voxel/visibility/trace.comp", kTraceBindings, kTracePushBytes,
        {{0, 2u - static_cast<uint32_t>(skip)}, {1, hit}, {2, frame}, {3, near}, {4, masked}, {6, corners}, {7, skyImage}, {8, someRays}});
  };
  if (traversal_ == Traversal::Dda && skip_ == Skip::Clearance) {
    for (uint32_t axis = 0; axis < 3; ++axis)
      clearanceSums_[axis] = make("clustered_voxel/visibility/clearance_sums.comp", 5, 0, {{0, axis}});
    clearanceBoxes_ = make("clustered_voxel/visibility/clearance_boxes.comp", 5, 0, {});
  }
  // Where the clearance of a large grid does not fit one binding, bricks do.
  const bool mayNeedBricks = traversal_ == Traversal::Dda && skip_ == Skip::Clearance;
  trace_ = makeTrace(skip_, 0);
  if (mayNeedBricks) traceBricks_ = makeTrace(Skip::Bricks, 0);
  if (keep_) {
    traceSome_ = makeTrace(skip_, 1);
    if (mayNeedBricks) traceSomeBricks_ = makeTrace(Skip::Bricks, 1);
    kept_.prepare(context, rays_,
                  make("clustered_voxel/visibility/reuse.comp", kReuseBindings, KeptHits::kPushBytes,
                       {{1, hit}, {2, frame}, {3, near}, {4, masked}, {6, corners}}));
  }
  std::vector<uint32_t> directions = makeDirections(rays_);
  directions.resize(shared::kShiftCount * shared::kMaxRays);
  directions_ = gpu::Buffer(device, "visibility directions", directions.size() * sizeof(uint32_t));
  gpu::upload(device, directions_, directions);
}

uint32_t Visibility::chunkCount(graph::RecordContext& context) const {
  return static_cast<uint32_t>((context.count("faces") + kRowsPerChunk - 1) / kRowsPerChunk);
}

uint32_t Visibility::rowCount(graph::RecordContext& context, uint32_t chunk) const {
  return static_cast<uint32_t>(std::min<uint64_t>(kRowsPerChunk, context.count("faces") - uint64_t{chunk} * kRowsPerChunk));
}

// Step 0 learns the grid and counts planes; step 1 makes them, and compares with what is kept; step firstTrace() + k fills chunk k − 1 and traces chunk k.
uint32_t Visibility::stepCount(graph::RecordContext& context) {
  const uint32_t chunks = chunkCount(context);
  return chunks == 0 ? 2 : firstTrace() + chunks + 1;
}

void Visibility::record(graph::RecordContext& context) {
  const uint32_t step = context.step();
  if (step == 0) {
    context.commands().fill(context.buffer("row_start"), 0);
    context.commands().fill(context.buffer("chunk_table"), 0);
    context.commands().fill(context.buffer("weights"), 0);
    context.commands().fill(context.buffer("entry_count"), 0);
    countPlanes(context);
    return;
  }
  context.commands().barrier();
  if (step == 1) {
    if (!context.grown("planes").empty()) recordPlanes(context);
    if (!context.grown("clearance").empty()) recordClearance(context);
    if (keep_ && chunkCount(context) > 0) kept_.recordVoxels(context);
  }
  if (step < firstTrace()) return;
  const uint32_t chunk = step - firstTrace();
  if (chunk > 0) recordFill(context, chunk - 1);
  if (chunk < chunkCount(context)) recordTrace(context, chunk);
}

void Visibility::stepDone(graph::RecordContext& context) {
  const uint32_t step = context.step();
  const uint32_t chunks = chunkCount(context);
  if (step == 0) begin(context);
  if (step == 1 && usesClearance()) context.clearGrown("clearance_work");
  if (step == 1 && keep_) kept_.readChanges(context);
  if (step >= firstTrace() && step - firstTrace() < chunks) {
    uint32_t total[2];
    const std::vector<std::byte> raw = context.readBuffer("total", 0, sizeof(total));
    std::memcpy(total, raw.data(), sizeof(total));
    context.grow("entries", (uint64_t{total[0]} + 31) / 32 * 4 + uint64_t{shared::kRowPadding} * 4);
    context.reportProgress(static_cast<double>(step - firstTrace() + 1) / chunks);
  }
  if (step + 1 < stepCount(context)) return;
  if (keep_) kept_.end(context);
  if (context.has("pieces")) context.clearGrown("pieces");
  uint32_t entryCount = 0;
  const std::vector<std::byte> raw = context.readBuffer("entry_count", 0, sizeof(entryCount));
  std::memcpy(&entryCount, raw.data(), sizeof(entryCount));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double faces = static_cast<double>(context.count("faces"));
  context.setCount("entries", entryCount);
  context.reportStat("rays", faces * rays_);
  context.reportStat("mrays_per_second", seconds > 0 ? faces * rays_ / seconds * 1e-6 : 0);
  context.reportStat("entries", static_cast<double>(entryCount));
  context.reportStat("mean_row", faces > 0 ? static_cast<double>(entryCount) / faces : 0);
  context.reportStat("clearance_bytes", usesClearance() && faces > 0 ? static_cast<double>(clearanceBytes(grid_)) : 0);
}

void Visibility::begin(graph::RecordContext& context) {
  const std::vector<std::byte> raw = context.readBuffer("grid", 0, sizeof(grid_));
  std::memcpy(&grid_, raw.data(), sizeof(grid_));
  const uint64_t ids = context.count("faces") + context.count("clusters");
  if (ids > shared::kMissBase) {
    // Faces grow with N² and clusters hardly.
    const uint32_t resolution = std::max({grid_.size.x, grid_.size.y, grid_.size.z});
    const double fits = std::sqrt(static_cast<double>(shared::kMissBase) / static_cast<double>(ids)) * 0.98 * resolution;
    throw Error(ErrorCode::OutOfMemory, "visibility: " + std::to_string(ids) + " faces and clusters at resolution " +
                                            std::to_string(resolution) + " do not fit the 24 bits of an entry; use voxelize.resolution=" +
                                            std::to_string(static_cast<uint32_t>(fits)) + " or less");
  }
  context.clearGrown("entries");
  context.clearGrown("clearance");
  context.clearGrown("planes");
  if (keep_) kept_.begin(context, grid_);
  start_ = std::chrono::steady_clock::now();
  clearanceTooLarge_ = maxRange_ != 0 && 4 * rimmedVoxels(grid_) > maxRange_;
  const uint64_t voxels = context.count("voxels");
  if (voxels == 0) return;
  uint32_t extras[2];
  const std::vector<std::byte> total = context.readBuffer("total", 0, sizeof(extras));
  std::memcpy(extras, total.data(), sizeof(extras));
  context.grow("planes", 8 * (voxels + extras[0]));
  if (!usesClearance() || chunkCount(context) == 0) return;
  context.grow("clearance", clearanceBytes(grid_));
  context.grow("clearance_work", 4 * rimmedVoxels(grid_));
}

void Visibility::countPlanes(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto voxels = static_cast<uint32_t>(context.count("voxels"));
  if (voxels == 0) return;
  const gpu::Buffer& extras = context.buffer("plane_extras");
  const gpu::Buffer& none = context.buffer("grid");
  commands.bind(countPlanes_, {context.buffer("mask"), context.buffer("first"), context.buffer("faces"), none, extras});
  commands.push(voxels);
  commands.dispatchItems(voxels, 64);
  commands.barrier();
  scan_->scan(commands, extras, extras, voxels, context.buffer("plane_scan"), &context.buffer("total"));
}

void Visibility::recordPlanes(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto voxels = static_cast<uint32_t>(context.count("voxels"));
  commands.bind(planes_, {context.buffer("mask"), context.buffer("first"), context.buffer("faces"), *context.grown("planes").at(0),
                          context.buffer("plane_extras")});
  commands.push(voxels);
  commands.dispatchItems(voxels, 64);
  commands.barrier();
}

void Visibility::recordClearance(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& result = *context.grown("clearance").at(0);
  const gpu::Buffer& work = *context.grown("clearance_work").at(0);
  const glm::uvec3 size = grid_.size + 2u;
  for (int axis = 0; axis < 3; ++axis) {
    commands.bind(clearanceSums_[static_cast<size_t>(axis)],
                  {context.buffer("grid"), context.buffer("occupancy"), context.buffer("rank"), context.buffer("mask"), work});
    commands.dispatchItems(uint64_t{size[(axis + 1) % 3]} * size[(axis + 2) % 3], 64);
    commands.barrier();
  }
  commands.bind(clearanceBoxes_, {context.buffer("grid"), context.buffer("occupancy"), context.buffer("rank"), work, result});
  commands.dispatchItems(rimmedVoxels(grid_), 64);
  commands.barrier();
}

void Visibility::recordTrace(graph::RecordContext& context, uint32_t chunk) {
  gpu::Commands& commands = context.commands();
  const uint32_t firstFace = chunk * kRowsPerChunk;
  const uint32_t rows = rowCount(context, chunk);
  const gpu::Buffer& order = context.buffer("order");
  const gpu::Buffer& hits = context.buffer("hits");
  const gpu::Buffer& table = context.buffer("table");
  const gpu::Buffer& offsets = context.buffer("offsets");
  const bool hasTriangles = context.has("triangle_ids");
  std::vector<const gpu::Buffer*> ids;
  if (hasTriangles) ids = context.grown("triangle_ids");
  const auto optional = [&](const char* name) -> const gpu::Buffer& {
    return hasTriangles ? context.buffer(name) : context.buffer("grid");
  };
  struct {
    uint32_t firstFace, rowCount, rayCount;
    float nearDistance;
    uint32_t voxelCount;
    float triangles;
  } tracePush{firstFace, rows, rays_, near_, static_cast<uint32_t>(context.count("voxels")), triangles_};
  static_assert(sizeof(tracePush) == kTracePushBytes);
  // An absent clearance is never read.
  const gpu::Buffer& clearance = usesClearance() ? *context.grown("clearance").at(0) : context.buffer("grid");
  const std::vector<gpu::BoundResource> bindings{context.buffer("grid"),
                                                 context.buffer("occupancy"),
                                                 context.buffer("rank"),
                                                 context.buffer("voxels"),
                                                 context.buffer("distance"),
                                                 *context.grown("planes").at(0),
                                                 context.buffer("first"),
                                                 context.buffer("faces"),
                                                 clearance,
                                                 directions_,
                                                 order,
                                                 hits,
                                                 context.buffer("plane_extras"),
                                                 optional("triangle_first"),
                                                 ids.empty() ? context.buffer("grid") : *ids.front(),
                                                 optional("scene.vertices"),
                                                 optional("scene.indices"),
                                                 optional("scene.triangle_materials"),
                                                 optional("scene.materials"),
                                                 optional("scene.textures"),
                                                 ids.empty() ? context.buffer("grid") : *context.grown("pieces").front(),
                                                 context.has("corners") ? context.buffer("corners") : context.buffer("grid")};
  const bool some = keep_ && kept_.reuses();
  if (some) kept_.recordReuse(context, bindings, &tracePush, rows);
  const gpu::Buffer& todo = some ? context.buffer("todo") : context.buffer("grid");
  struct {
    uint32_t firstFace, rowCount, wordCount;
  } sortPush{firstFace, rows, shared::rayWords(rays_)};
  commands.bind(some ? sortSome_ : sortRows_, {context.buffer("faces"), order, optional("triangle_first"), todo});
  commands.push(sortPush);
  commands.dispatch(1);
  commands.fill(table, shared::kEmptySlot);
  commands.barrier();
  std::vector<gpu::BoundResource> traceBindings = bindings;
  traceBindings.push_back(todo);
  const bool bricks = traversal_ == Traversal::Dda && skip_ == Skip::Clearance && clearanceTooLarge_;
  commands.bind(bricks ? (some ? traceSomeBricks_ : traceBricks_) : (some ? traceSome_ : trace_), traceBindings);
  commands.push(tracePush);
  const uint32_t lanes = (rows + 63) / 64 * 64;
  commands.dispatchItems(uint64_t{lanes} * ((rays_ + shared::kRaysPerLane - 1) / shared::kRaysPerLane), 64);
  commands.barrier();
  if (keep_) kept_.recordHits(context, firstFace, rows);
  struct {
    uint32_t rowCount, rayCount, tableBits, clusterCount, firstFace, faceCount;
  } mergePush{rows,
              rays_,
              tableBits(rays_),
              static_cast<uint32_t>(context.count("clusters")),
              firstFace,
              static_cast<uint32_t>(context.count("faces"))};
  commands.bind(merge_, {hits, context.buffer("labels"), table, offsets, context.buffer("faces"), context.buffer("weights"),
                         context.buffer("entry_count")});
  commands.push(mergePush);
  commands.dispatchItems(kRowsPerChunk + 1, 64);
  commands.barrier();
  scan_->scan(commands, offsets, offsets, kRowsPerChunk + 1, context.buffer("scan"), &context.buffer("total"));
}

void Visibility::recordFill(graph::RecordContext& context, uint32_t chunk) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& entries = *context.grown("entries").at(chunk);
  const VkDeviceAddress address = entries.address();
  commands.update(context.buffer("chunk_table"), &address, sizeof(address), uint64_t{chunk} * sizeof(address));
  commands.fill(entries, 0);
  commands.barrier();
  struct {
    uint32_t rowCount, tableBits, firstRowStart, idCount;
  } push{rowCount(context, chunk), tableBits(rays_), chunk * (kRowsPerChunk + 1),
         static_cast<uint32_t>(context.count("clusters") + context.count("faces"))};
  commands.bind(fill_, {context.buffer("table"), context.buffer("offsets"), entries, context.buffer("row_start")});
  commands.push(push);
  commands.dispatchItems(kRowsPerChunk + 1, 64);
  commands.barrier();
}

}  // namespace radivox::clustered_voxel
