#include "modules/clustered_voxel/bounce/bounce.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <string>

#include "shaders/shared/transfer_entry.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

using graph::Extent;
using graph::Shape;
using shared::BounceControl;
using shared::BouncePush;

namespace {

constexpr uint32_t kGroup = 64;
constexpr uint32_t kRowsPerGroup = 8;
constexpr VkDeviceSize kStatusBytes = 16;

/// One where none is asked for but they are kept, or the sky's share of the same rays is asked for: the picture leaves it out.
uint32_t bouncesOf(const scene::Request& request, const scene::Traits& traits) {
  return request.bounces == 0 && (traits.sky || traits.keeps(scene::Feature::Bounces)) ? 1 : request.bounces;
}

/// B⁰.
const gpu::Buffer& sourceOf(graph::RecordContext& context) {
  return context.buffer(context.has("emission") ? "source" : "direct_radiosity");
}

gpu::Pipeline makePipeline(gpu::Device& device, const char* shader, size_t bindingCount,
                           std::vector<gpu::SpecializationConstant> constants = {}) {
  return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = shader,
                                                        .bindings = std::vector(bindingCount, gpu::BindingType::StorageBuffer),
                                                        .pushConstantBytes = sizeof(BouncePush),
                                                        .constants = std::move(constants)});
}

}  // namespace

Bounce::Bounce()
    : table_({params::choice("solver", &solver_, {"chebyshev", "plain"}, "accelerated, or plain iteration (for comparison)",
                             params::Invalidates::Rerun),
              params::choice("last", &last_, {"faces", "clusters", "auto"},
                             "who receives the last bounce: each face by its own rays (where they are connected), its cluster, or (auto) "
                             "faces where the sky's light keeps their rows in memory anyway, else clusters",
                             params::Invalidates::Plan),
              params::swept(params::number("residual", &residual_, {1e-7, 0.1}, "where to stop: largest residual over the largest source",
                                           params::Invalidates::Rerun),
                            {"0.01", "0.001", "0.0001"}, "0.000001"),
              params::number("iterations", &iterations_, {1, 20000}, "most iterations", params::Invalidates::Rerun)}) {}

void Bounce::declare(graph::Declaration& d) {
  const uint32_t bounces = bouncesOf(d.request, d.traits);
  if (bounces == 0) {
    d.leaveOut("direct light only");
    return;
  }
  if (bounces != scene::kAllBounces && bounces - 1 > iterations_)
    throw Error(ErrorCode::BadInput, "bounces=" + std::to_string(bounces) + ": bounce.iterations=" + std::to_string(iterations_) +
                                         " allows at most " + std::to_string(iterations_ + 1) +
                                         "; ask for all bounces, or raise bounce.iterations");
  const bool emits = d.traits.hasEmissionByRays();
  const bool needsMatrix = bounces > 1 || emits || d.traits.keeps(scene::Feature::Matrix);
  for (const char* name : {"row_start", "entries"}) {
    d.readIf(needsMatrix, name, "form factors between clusters", "one bounce needs no light between clusters").optional = !needsMatrix;
  }
  const bool toFaces = last_ == Last::Faces || (last_ == Last::Auto && d.traits.sky);
  const bool needsRows = bounces > 1 && toFaces;
  for (const char* name : {"visibility_row_start", "visibility_entries", "chunk_table"})
    d.readIf(needsRows, name, "rows of the faces",
             bounces > 1 ? "the last bounce goes to clusters" : "one bounce needs no light between clusters");
  d.read("clusters", "Cluster");
  d.read("members", "members of the clusters, with their shares in its means");
  d.readIf(needsRows, "labels", "cluster id of each face", "faces receive what their cluster does").optional = true;
  d.read("faces", "Face");
  const char* noEmission = d.traits.emissiveTriangleCount == 0 ? "nothing emits" : "emitters light through samples, in inject";
  d.readIf(emits, "emission", "mean B_e of each face, W/m²", noEmission).optional = !emits;
  d.read("face_irradiance", "E_dir of each face, W/m²");
  d.read("direct_radiosity", "reflected direct light of each cluster, W/m²", graph::UseCompute | graph::UseTransfer);
  d.write("cluster_radiosity", Shape::buffer(12, Extent::of("clusters")), "reflected radiosity, W/m²");
  d.write("face_radiosity", Shape::buffer(12, Extent::of("faces")), "reflected radiosity, W/m²");
  d.write("cluster_emission", Shape::buffer(12, Extent::of("clusters")),
          "mean B_e of each cluster, W/m²; made where emitters light by rays")
      .optional = !emits;
  d.readBack("status", Shape::buffer(4, 4),
             "iterations; residual (float bits); 1: fell back; 1: residual reached, 2: rounding, 0: neither");
  d.scratch("control", Shape::buffer(sizeof(BounceControl), 1), "state of the solver",
            graph::UseCompute | graph::UseTransfer | graph::UseIndirect);
  // Where nothing emits by rays, B⁰ is direct_radiosity. In cluster_radiosity lies the last change of B, then E_ind = F B, until B takes its place.
  if (emits) d.scratch("source", Shape::buffer(12, Extent::of("clusters")), "B⁰");
  if (needsMatrix) {
    d.scratch("iterate", Shape::buffer(24, Extent::of("clusters")), "B before and after a step");
  }
  if (emits) {
    d.scratch("received", Shape::buffer(12, Extent::of("clusters")), "E_emit = F B_e");
  }
}

void Bounce::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  if (context.has("emission")) {
    meanEmission_ = makePipeline(device, "clustered_voxel/bounce/mean_emission.comp", 5);
    receiveEmission_ = makePipeline(device, "clustered_voxel/bounce/receive_emission.comp", 3);
  }
  if (context.has("entries")) {
    source_ = makePipeline(device, "clustered_voxel/bounce/source.comp", 6);
    begin_ = makePipeline(device, "clustered_voxel/bounce/begin.comp", 4);
    sweep_ = makePipeline(device, "clustered_voxel/bounce/sweep.comp", 6);
    receive_ = makePipeline(device, "clustered_voxel/bounce/receive.comp", 4);
    finishClusters_ = makePipeline(device, "clustered_voxel/bounce/finish_clusters.comp", 3);
  }
  hasRows_ = context.has("visibility_entries") && context.has("labels");
  if (hasRows_)
    finishFaces_ = makePipeline(device, "clustered_voxel/bounce/finish_faces.comp", 10);
  else
    finishFaces_ = makePipeline(device, "clustered_voxel/bounce/finish_members.comp", 7);
}

BounceControl Bounce::makeControl(uint32_t clusterCount, bool counted) const {
  BounceControl control{};
  const uint32_t groups = (clusterCount + kRowsPerGroup - 1) / kRowsPerGroup;
  constexpr uint32_t kRow = gpu::Commands::kMaxGroupsX;
  control.groups = groups <= kRow ? glm::uvec3(groups, 1, 1) : glm::uvec3(kRow, (groups + kRow - 1) / kRow, 1);
  control.phase = counted ? shared::kPhaseCounted : solver_ == Solver::Plain ? shared::kPhasePlain : shared::kPhaseWarmUp;
  control.omega = glm::vec3(1.f);
  control.windowMeasure = std::numeric_limits<float>::max();
  return control;
}

void Bounce::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto clusterCount = static_cast<uint32_t>(context.count("clusters"));
  const auto faceCount = static_cast<uint32_t>(context.count("faces"));
  const gpu::Buffer& control = context.buffer("control");
  const gpu::Buffer& status = context.buffer("status");
  if (clusterCount == 0) {
    commands.fill(status, 0);
    return;
  }
  const bool hasMatrix = context.has("entries");
  const bool hasEmission = context.has("emission");
  const uint32_t bounces = bouncesOf(context.request(), context.traits());
  const bool counted = bounces != scene::kAllBounces;
  BouncePush push{};
  push.matrix = glm::uvec2(0);
  if (hasMatrix) {
    // An import is one buffer; transfer grows its own.
    const std::vector<const gpu::Buffer*> grown = context.grown("entries");
    const VkDeviceAddress address = (grown.empty() ? context.buffer("entries") : *grown.front()).address();
    push.matrix = glm::uvec2(static_cast<uint32_t>(address), static_cast<uint32_t>(address >> 32));
  }
  push.clusterCount = clusterCount;
  push.weightBits = shared::transferWeightBits(clusterCount);
  push.faceCount = faceCount;
  push.iterationLimit = iterations_;
  push.tolerance = residual_;
  push.startBelow = counted ? 0u : 1u;
  push.hasEmission = hasEmission ? 1u : 0u;

  const BounceControl initial = makeControl(clusterCount, counted);
  commands.update(control, &initial, sizeof(initial));
  commands.fill(context.buffer("cluster_radiosity"), 0);
  commands.barrier();
  if (hasMatrix && hasEmission) recordEmission(context, push);
  if (hasMatrix) recordSweeps(context, push, counted ? bounces - 1 : iterations_);
  // Faces with rows receive what clusters send in the end; others what their cluster received.
  if (hasRows_) {
    recordClusters(context, push);
    recordFaces(context, push, counted ? bounces - 1 : 0);
  } else {
    recordMembers(context, push);
    recordClusters(context, push);
  }
  commands.copy(control, status, kStatusBytes, offsetof(BounceControl, iterations));
}

void Bounce::recordEmission(graph::RecordContext& context, const BouncePush& push) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& mean = context.buffer("cluster_emission");
  commands.bind(meanEmission_,
                {context.buffer("clusters"), context.buffer("members"), context.buffer("faces"), context.buffer("emission"), mean});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kGroup);
  commands.barrier();
  commands.bind(receiveEmission_, {context.buffer("row_start"), mean, context.buffer("received")});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kRowsPerGroup);
  commands.barrier();
}

/// From E_ind to B, in place.
void Bounce::recordClusters(graph::RecordContext& context, const BouncePush& push) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& radiosity = context.buffer("cluster_radiosity");
  commands.barrier();
  if (!context.has("entries")) {
    commands.copy(context.buffer("direct_radiosity"), radiosity, uint64_t{push.clusterCount} * 12);
    return;
  }
  commands.bind(finishClusters_, {context.buffer("clusters"), sourceOf(context), radiosity});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kGroup);
}

void Bounce::recordFaces(graph::RecordContext& context, BouncePush push, uint32_t sweeps) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& radiosity = context.buffer("cluster_radiosity");
  // Where bounces are counted, faces receive the last one in place of the clusters: from what these sent before their last sweep.
  push.senders = sweeps > 0 && (sweeps - 1) % 2 != 0 ? push.clusterCount : 0;
  commands.barrier();
  commands.bind(finishFaces_, {context.buffer("faces"), context.buffer("labels"), context.buffer("face_irradiance"),
                               context.buffer("face_radiosity"), context.buffer("visibility_row_start"), context.buffer("chunk_table"),
                               sweeps > 0 ? context.buffer("iterate") : radiosity, context.buffer("direct_radiosity"),
                               push.hasEmission != 0 ? context.buffer("cluster_emission") : radiosity, context.buffer("clusters")});
  commands.push(push);
  commands.dispatchItems(push.faceCount, kGroup);
}

void Bounce::recordMembers(graph::RecordContext& context, const BouncePush& push) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& indirect = context.buffer("cluster_radiosity");
  commands.barrier();
  commands.bind(finishFaces_,
                {context.buffer("faces"), context.buffer("clusters"), context.buffer("members"), context.buffer("face_irradiance"),
                 push.hasEmission != 0 ? context.buffer("received") : indirect, indirect, context.buffer("face_radiosity")});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kGroup);
}

void Bounce::recordSweeps(graph::RecordContext& context, const BouncePush& push, uint32_t count) const {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& control = context.buffer("control");
  const gpu::Buffer& direct = context.buffer("direct_radiosity");
  const bool emits = push.hasEmission != 0;
  const gpu::Buffer& source = sourceOf(context);
  const gpu::Buffer& iterate = context.buffer("iterate");
  const gpu::Buffer& steps = context.buffer("cluster_radiosity");
  commands.bind(source_, {context.buffer("row_start"), context.buffer("clusters"), direct, emits ? context.buffer("received") : direct,
                          emits ? source : iterate, control});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kRowsPerGroup);
  commands.barrier();
  commands.bind(begin_, {source, control, iterate, steps});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kGroup);
  commands.barrier();
  commands.bind(sweep_, {context.buffer("row_start"), context.buffer("clusters"), source, iterate, steps, control});
  commands.push(push);
  for (uint32_t i = 0; i < count; ++i) {
    commands.dispatchIndirect(control, offsetof(BounceControl, groups));
    commands.barrier();
  }
  commands.bind(receive_, {context.buffer("row_start"), iterate, steps, control});
  commands.push(push);
  commands.dispatchItems(push.clusterCount, kRowsPerGroup);
  commands.barrier();
}

void Bounce::frameDone(graph::RecordContext& context) {
  uint32_t words[4];
  std::memcpy(words, context.buffer("status").mapped(), sizeof(words));
  context.reportStat("iterations", words[0]);
  context.reportStat("residual", static_cast<double>(std::bit_cast<float>(words[1])));
  context.reportStat("fallback", words[2]);
  context.reportStat("stop_reason", words[3]);
}

}  // namespace radivox::clustered_voxel
