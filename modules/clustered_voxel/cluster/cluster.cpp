#include "modules/clustered_voxel/cluster/cluster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "modules/clustered_voxel/structure.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;
using shared::ClusterControl;
using shared::ClusterPush;

namespace {

constexpr uint32_t kGroup = shared::kClusterGroup;
constexpr uint32_t kNone = 0xffffffffu;

gpu::Pipeline makePipeline(gpu::Device& device, const char* shader, size_t bindingCount) {
  return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = shader,
                                                        .bindings = std::vector(bindingCount, gpu::BindingType::StorageBuffer),
                                                        .pushConstantBytes = sizeof(ClusterPush)});
}

/// Binds, pushes and gives every item a lane; later commands see what it wrote.
void runItems(gpu::Commands& commands, const gpu::Pipeline& pipeline, std::initializer_list<gpu::BoundResource> resources,
              const ClusterPush& push, uint32_t itemCount) {
  commands.bind(pipeline, resources);
  commands.push(push);
  commands.dispatchItems(itemCount, kGroup);
  commands.barrier();
}

/// The k-th part of a buffer that holds several arrays of one word a face; parts begin at multiples of 256 bytes.
gpu::BoundResource partOf(const gpu::Buffer& buffer, uint32_t k, uint32_t faceCount) {
  const VkDeviceSize bytes = static_cast<VkDeviceSize>((faceCount + 63) / 64) * 256;
  return {buffer, k * bytes, bytes};
}

}  // namespace

Cluster::Cluster()
    : table_({params::swept(params::number("spacing", &spacing_, {2, 32}, "seed spacing S, voxels", params::Invalidates::Rerun),
                            {"12", "8", "6", "4", "3"}, "2"),
              params::number("angle", &angleDegrees_, {5, 44}, "largest angle between a face's normal and its seed's, degrees",
                             params::Invalidates::Rerun),
              params::number("space_weight", &spaceWeight_, {0, 100},
                             "weight of |x - c|²/S² in the distance; 0: normals only, as in the paper", params::Invalidates::Rerun),
              params::number("normal_weight", &normalWeight_, {0, 100}, "weight of (1 - n·n_c)/(1 - cos angle) in the distance",
                             params::Invalidates::Rerun),
              params::number("iterations", &iterations_, {1, 100}, "most rounds of assignment", params::Invalidates::Rerun),
              params::number("stop_fraction", &stopFraction_, {0, 1}, "stop when no larger share of the faces changed",
                             params::Invalidates::Rerun),
              params::number("merge", &merge_, {0, shared::kMostMergeFaces}, "clusters of at most this many faces join a neighbour",
                             params::Invalidates::Rerun)}) {}

void Cluster::declare(graph::Declaration& d) {
  declareStructure(d);
  const Extent faces = Extent::of("faces");
  d.write("labels", Shape::buffer(4, faces), "cluster id of each face");
  d.write("count", Shape::buffer(4, 2), "clusters; 0");
  d.publishCount("clusters", "count", 0);
  d.readBack("status", Shape::buffer(sizeof(ClusterControl), 1), "ClusterControl as the run left it");
  d.scratch("control", Shape::buffer(sizeof(ClusterControl), 1), "dispatch arguments and counters",
            graph::UseCompute | graph::UseTransfer | graph::UseIndirect);
  d.scratch("slot_keys", Shape::buffer(8, faces), "table of seed cells: key");
  d.scratch("slot_cells", Shape::buffer(8, faces), "table of seed cells: founder, then cell");
  d.scratch("face_cells", Shape::buffer(4, faces), "slot, then cell of each face");
  d.scratch("ranks", Shape::buffer(4, faces), "flags and their scan");
  d.scratch("cell_keys", Shape::buffer(4, faces), "packed coordinate of each cell");
  d.scratch("cell_masks", Shape::buffer(4, faces), "dominant directions in each cell");
  d.scratch("first_seeds", Shape::buffer(4, faces), "first seed of each cell");
  d.scratch("seed_starts", Shape::buffer(4, faces + 1), "first face of each seed, as planted");
  d.scratch("sorted", Shape::buffer(4, faces), "faces by cell and direction; then union-find parents");
  d.scratch("cursors", Shape::buffer(4, faces), "filling level of each seed's part; then pieces");
  d.scratch("seed_labels", Shape::buffer(4, faces), "seed of each face, or none");
  d.scratch("seed_homes", Shape::buffer(4, faces), "packed home cell of each seed");
  d.scratch("seeds", Shape::buffer(24, faces), "position and normal of each seed");
  d.scratch("moments", Shape::buffer(16, faces), "sums of normals, members; then size and members of pieces");
  d.scratch("positions", Shape::buffer(3 * 256, faces / 64), "sums of positions; then targets, links and lowest faces of pieces");
  // Covers Scan::scratchBytes: two words a block of 1024 items, the same for their sums, each level at an aligned offset.
  d.scratch("scan", Shape::buffer(4, faces / 256 + 512), "scan");
}

void Cluster::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  scan_ = std::make_unique<gpu::Scan>(device);
  insertCells_ = makePipeline(device, "clustered_voxel/cluster/insert_cells.comp", 5);
  flagFounders_ = makePipeline(device, "clustered_voxel/cluster/flag_founders.comp", 3);
  numberCells_ = makePipeline(device, "clustered_voxel/cluster/number_cells.comp", 6);
  countCells_ = makePipeline(device, "clustered_voxel/cluster/count_cells.comp", 4);
  countSeeds_ = makePipeline(device, "clustered_voxel/cluster/count_seeds.comp", 2);
  labelFaces_ = makePipeline(device, "clustered_voxel/cluster/label_faces.comp", 8);
  sortFaces_ = makePipeline(device, "clustered_voxel/cluster/sort_faces.comp", 4);
  arguments_ = makePipeline(device, "clustered_voxel/cluster/arguments.comp", 1);
  accumulate_ = makePipeline(device, "clustered_voxel/cluster/accumulate.comp", 6);
  updateSeeds_ = makePipeline(device, "clustered_voxel/cluster/update_seeds.comp", 5);
  assign_ = makePipeline(device, "clustered_voxel/cluster/assign.comp", 15);
  decide_ = makePipeline(device, "clustered_voxel/cluster/decide.comp", 1);
  startPieces_ = makePipeline(device, "clustered_voxel/cluster/start_pieces.comp", 1);
  connect_ = makePipeline(device, "clustered_voxel/cluster/connect.comp", 9);
  connectOrphans_ = makePipeline(device, "clustered_voxel/cluster/connect_orphans.comp", 10);
  countPieces_ = makePipeline(device, "clustered_voxel/cluster/count_pieces.comp", 5);
  choose_ = makePipeline(device, "clustered_voxel/cluster/choose.comp", 12);
  mergePieces_ = makePipeline(device, "clustered_voxel/cluster/merge.comp", 3);
  relabel_ = makePipeline(device, "clustered_voxel/cluster/relabel.comp", 3);
  lowestFaces_ = makePipeline(device, "clustered_voxel/cluster/lowest_faces.comp", 2);
  flagLowest_ = makePipeline(device, "clustered_voxel/cluster/flag_lowest.comp", 3);
  writeLabels_ = makePipeline(device, "clustered_voxel/cluster/write_labels.comp", 4);
}

ClusterPush Cluster::makePush(uint32_t faceCount, uint32_t voxelCount) const {
  const double angle = static_cast<double>(angleDegrees_) * std::numbers::pi / 180.0;
  const double s = spacing_;
  ClusterPush push{};
  push.faceCount = faceCount;
  push.voxelCount = voxelCount;
  push.spacing = spacing_;
  push.hashSize = 2 * faceCount;
  push.spaceScale = static_cast<float>(static_cast<double>(spaceWeight_) / (s * s));
  push.normalScale = static_cast<float>(static_cast<double>(normalWeight_) / (1.0 - std::cos(angle)));
  push.cosAngle = static_cast<float>(std::cos(angle));
  push.sinAngle = static_cast<float>(std::sin(angle));
  // No seed has more members than the voxel faces of 27 cells.
  const double memberCount = std::min(162.0 * s * s * s, static_cast<double>(faceCount));
  const auto fits = [memberCount](double largest) { return memberCount * (largest + 1.0) < 2147483648.0; };
  while (!fits((1.5 * s + 1.0) * 1023.0 / static_cast<double>(1u << push.positionShift))) ++push.positionShift;
  double normalUnit = 32767.0;
  while (!fits(normalUnit)) normalUnit *= 0.5;
  push.normalUnit = static_cast<float>(normalUnit);
  // A square of side w on the cube of directions is at most 2 atan(w / √2) across.
  push.orphanBins = static_cast<uint32_t>(std::ceil(std::numbers::sqrt2 / std::tan(0.5 * angle) + 1e-3));
  push.iterationLimit = iterations_;
  push.changeLimit = static_cast<uint32_t>(static_cast<double>(stopFraction_) * faceCount);
  push.mergeLimit = merge_;
  return push;
}

void Cluster::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& control = context.buffer("control");
  const gpu::Buffer& status = context.buffer("status");
  if (faceCount == 0) {
    commands.fill(context.buffer("count"), 0);
    commands.fill(status, 0);
    return;
  }
  const ClusterPush push = makePush(faceCount, static_cast<uint32_t>(context.count("voxels")));
  assert(context.buffer("scan").bytes() >= gpu::Scan::scratchBytes(faceCount + 1));
  commands.fill(control, 0);
  recordSeeds(context, push);
  recordIterations(context, push);
  recordPieces(context, push);
  recordLabels(context, push);
  commands.copy(control, status, sizeof(ClusterControl));
}

void Cluster::recordSeeds(graph::RecordContext& context, const ClusterPush& push) const {
  gpu::Commands& commands = context.commands();
  const auto b = [&context](const char* name) -> const gpu::Buffer& { return context.buffer(name); };
  commands.fill(b("slot_keys"), kNone);
  commands.fill(b("slot_cells"), kNone);
  commands.fill(b("seed_starts"), 0);
  commands.fill(b("cell_masks"), 0);
  commands.fill(b("cursors"), 0);
  commands.fill(b("moments"), 0);
  commands.fill(b("positions"), 0);
  commands.barrier();
  runItems(commands, insertCells_, {b("voxels"), b("faces"), b("slot_keys"), b("slot_cells"), b("face_cells")}, push, push.faceCount);
  runItems(commands, flagFounders_, {b("slot_cells"), b("face_cells"), b("ranks")}, push, push.faceCount);
  scan_->scan(commands, b("ranks"), b("ranks"), push.faceCount, b("scan"), &b("control"), offsetof(ClusterControl, cellCount));
  runItems(commands, numberCells_, {b("slot_keys"), b("slot_cells"), b("face_cells"), b("ranks"), b("cell_keys"), b("control")}, push,
           push.faceCount);
  runItems(commands, countCells_, {b("faces"), b("slot_cells"), b("face_cells"), b("cell_masks")}, push, push.faceCount);
  runItems(commands, countSeeds_, {b("cell_masks"), b("first_seeds")}, push, push.faceCount);
  scan_->scan(commands, b("first_seeds"), b("first_seeds"), push.faceCount, b("scan"), &b("control"), offsetof(ClusterControl, seedCount));
  runItems(
      commands, labelFaces_,
      {b("faces"), b("face_cells"), b("cell_masks"), b("first_seeds"), b("cell_keys"), b("seed_labels"), b("seed_homes"), b("seed_starts")},
      push, push.faceCount);
  scan_->scan(commands, b("seed_starts"), b("seed_starts"), push.faceCount + 1, b("scan"));
  runItems(commands, sortFaces_, {b("seed_labels"), b("seed_starts"), b("cursors"), b("sorted")}, push, push.faceCount);
  runItems(commands, arguments_, {b("control")}, push, 1);
}

void Cluster::recordIterations(graph::RecordContext& context, const ClusterPush& push) const {
  gpu::Commands& commands = context.commands();
  const auto b = [&context](const char* name) -> const gpu::Buffer& { return context.buffer(name); };
  const gpu::Buffer& control = b("control");
  runItems(commands, accumulate_, {b("voxels"), b("faces"), b("seed_labels"), b("seed_homes"), b("moments"), b("positions")}, push,
           push.faceCount);
  for (uint32_t i = 0; i < push.iterationLimit; ++i) {
    commands.bind(updateSeeds_, {b("seed_homes"), b("moments"), b("positions"), b("seeds"), control});
    commands.push(push);
    commands.dispatchIndirect(control, offsetof(ClusterControl, seedGroups));
    commands.barrier();
    commands.bind(assign_,
                  {b("voxels"), b("faces"), b("slot_keys"), b("slot_cells"), b("cell_keys"), b("cell_masks"), b("first_seeds"),
                   b("seed_starts"), b("sorted"), b("seeds"), b("seed_labels"), control, b("seed_homes"), b("moments"), b("positions")});
    commands.push(push);
    commands.dispatchIndirect(control, offsetof(ClusterControl, cellGroups));
    commands.barrier();
    runItems(commands, decide_, {control}, push, 1);
  }
}

void Cluster::recordPieces(graph::RecordContext& context, const ClusterPush& push) const {
  gpu::Commands& commands = context.commands();
  const auto b = [&context](const char* name) -> const gpu::Buffer& { return context.buffer(name); };
  const gpu::Buffer& parents = b("sorted");
  const gpu::Buffer& pieces = b("cursors");
  const gpu::Buffer& small = b("moments");
  const gpu::BoundResource targets = partOf(b("positions"), 0, push.faceCount);
  const gpu::BoundResource links = partOf(b("positions"), 1, push.faceCount);
  commands.fill(small, 0);
  runItems(commands, startPieces_, {parents}, push, push.faceCount);
  bindStructure(context, connect_, {b("voxels"), b("seed_labels"), parents});
  commands.push(push);
  commands.dispatchItems(push.voxelCount, kGroup);
  bindStructure(context, connectOrphans_, {b("voxels"), b("seed_labels"), b("face_cells"), parents});
  commands.push(push);
  commands.dispatchItems(push.faceCount, kGroup);
  commands.barrier();
  runItems(commands, countPieces_, {parents, b("seed_labels"), pieces, small, b("control")}, push, push.faceCount);
  for (uint32_t round = 0; round < kMergeRounds && push.mergeLimit > 0; ++round) {
    bindStructure(context, choose_, {b("voxels"), b("seed_labels"), b("seeds"), pieces, small, targets});
    commands.push(push);
    commands.dispatchItems(push.faceCount, kGroup);
    commands.barrier();
    runItems(commands, mergePieces_, {targets, links, b("control")}, push, push.faceCount);
    runItems(commands, relabel_, {links, pieces, small}, push, push.faceCount);
  }
}

void Cluster::recordLabels(graph::RecordContext& context, const ClusterPush& push) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& pieces = context.buffer("cursors");
  const gpu::Buffer& ranks = context.buffer("ranks");
  const gpu::BoundResource lowest = partOf(context.buffer("positions"), 2, push.faceCount);
  commands.fill(*lowest.buffer, kNone, lowest.offset, lowest.range);
  commands.barrier();
  runItems(commands, lowestFaces_, {pieces, lowest}, push, push.faceCount);
  runItems(commands, flagLowest_, {pieces, lowest, ranks}, push, push.faceCount);
  scan_->scan(commands, ranks, ranks, push.faceCount, context.buffer("scan"), &context.buffer("count"));
  runItems(commands, writeLabels_, {pieces, lowest, ranks, context.buffer("labels")}, push, push.faceCount);
}

void Cluster::frameDone(graph::RecordContext& context) {
  ClusterControl control{};
  std::memcpy(&control, context.buffer("status").mapped(), sizeof(control));
  const double faceCount = std::max(1.0, static_cast<double>(context.count("faces")));
  context.reportStat("cells", control.cellCount);
  context.reportStat("seeds", control.seedCount);
  context.reportStat("iterations", control.iterations);
  context.reportStat("changed_fraction", control.changed / faceCount);
  context.reportStat("orphans", control.orphanCount);
  context.reportStat("pieces", control.pieceCount);
  context.reportStat("merged", control.mergedCount);
  context.reportStat("clusters", static_cast<double>(context.count("clusters")));
}

}  // namespace radivox::clustered_voxel
