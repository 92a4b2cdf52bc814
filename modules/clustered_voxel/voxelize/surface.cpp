#include "modules/clustered_voxel/voxelize/surface.h"

#include <array>
#include <cstddef>

#include "modules/clustered_voxel/voxelize/faces.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
// Word by word: the total area, and the voxel edge to make it metres.
struct Check {
  uint32_t areaLow, areaHigh;
  float h;
};
}  // namespace

Surface::Surface()
    : table_({params::choice("normals", &normals_, {"mean", "heuristic"},
                             "mean: area-weighted per face; heuristic: the paper's, one axis a voxel", params::Invalidates::Plan),
              TrianglePass::methodParam(&method_)}) {}

void Surface::declare(graph::Declaration& d) {
  emissive_ = d.traits.hasEmitters();
  const uint32_t use = TrianglePass::useOf(method_);
  TrianglePass::declare(d, method_);
  d.read("scene.triangle_materials", "one a triangle", use);
  d.read("scene.materials", "Material", use | graph::UseCompute);
  d.read("scene.textures", "Texture", use);
  d.read("grid", "Grid", use | graph::UseTransfer);
  d.read("occupancy", "two words a brick", use);
  d.read("rank", "occupied voxels before the brick", use);
  d.read("voxels", "packed coordinate of each voxel");
  d.read("mask", "faces of each voxel", use);
  d.read("first", "first face of each voxel", use);
  for (const char* name : {"triangle_first", "triangle_ids"})
    d.read(name, "triangles of each voxel, and faces they are no part of", use).optional = true;
  const Extent voxels = Extent::of("voxels"), faces = Extent::of("faces");
  d.write("faces", Shape::buffer(sizeof(shared::Face), faces), "Face");
  d.write("emission", Shape::buffer(12, faces), "mean B_e of each face, W/m²; 0: dark").optional = true;
  const uint32_t sums = use | graph::UseTransfer;
  d.scratch("area_sums", Shape::buffer(8, faces), "Σ w", sums);
  d.scratch("albedo_sums", Shape::buffer(24, faces), "Σ w ρ", sums);
  d.scratch("position_sums", Shape::buffer(24, faces), "Σ w x", sums);
  d.scratch("normal_sums", Shape::buffer(24, faces), "Σ w (n + 1)", sums);
  if (emissive_) d.scratch("emission_sums", Shape::buffer(24, faces), "Σ w L_e", sums);
  d.scratch("footprints", Shape::buffer(4, faces), "where in the voxel", sums);
  d.scratch("emission_peak", Shape::buffer(4, 1), "bits of the largest radiance", sums);
  d.scratch("voxel_areas", Shape::buffer(8, voxels), "Σ area, h²", sums);
  if (normals_ == Normals::Heuristic) d.scratch("angle_sums", Shape::buffer(48, voxels), "Σ area · angle(n, e_f)", sums);
  d.scratch("check_words", Shape::buffer(4, 3), "Σ area over all voxels, voxel edge");
  d.readBack("check", Shape::buffer(4, 3), "Σ area over all voxels, voxel edge");
}

void Surface::prepare(graph::PrepareContext& context) {
  gpu::Device& device = context.device();
  constexpr auto kB = BindingType::StorageBuffer;
  wantsEmission_ = context.has("emission");
  const uint32_t heuristic = normals_ == Normals::Heuristic ? 1 : 0;
  std::vector<gpu::SpecializationConstant> constants = materialConstants(context.traits());
  constants.push_back({3, heuristic});
  constants.push_back({4, context.has("triangle_ids") ? 1u : 0u});
  pass_.prepare(device, method_, kType, "surface", 22, constants);
  if (emissive_)
    emissionPeak_ = gpu::Pipeline(
        device,
        gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/emission_peak.comp", .bindings = {kB, kB}, .pushConstantBytes = 4});
  resolve_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "clustered_voxel/voxelize/surface_resolve.comp",
                                                            .bindings = std::vector<BindingType>(17, kB),
                                                            .pushConstantBytes = 4,
                                                            .constants = {{0, emissive_ && wantsEmission_ ? 1u : 0u}, {1, heuristic}}});
}

void Surface::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  for (const char* name :
       {"area_sums", "albedo_sums", "position_sums", "normal_sums", "footprints", "emission_peak", "voxel_areas", "check_words"})
    commands.fill(context.buffer(name), 0);
  if (emissive_) commands.fill(context.buffer("emission_sums"), 0);
  if (normals_ == Normals::Heuristic) commands.fill(context.buffer("angle_sums"), 0);
  if (wantsEmission_ && !emissive_) commands.fill(context.buffer("emission"), 0);
  commands.barrier();
  sumPieces(context);
  commands.barrier();
  resolveFaces(context);
  commands.barrier();
  commands.copy(context.buffer("grid"), context.buffer("check"), 4, offsetof(shared::Grid, h), offsetof(Check, h));
  commands.copy(context.buffer("check_words"), context.buffer("check"), 8);
}

void Surface::sumPieces(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Buffer& grid = context.buffer("grid");
  const gpu::Buffer& peak = context.buffer("emission_peak");
  if (emissive_) {
    const gpu::Buffer& materials = context.buffer("scene.materials");
    commands.bind(emissionPeak_, {materials, peak});
    commands.push(context.traits().materialCount);
    commands.dispatchItems(context.traits().materialCount, 64);
    commands.barrier();
  }
  const std::vector<const gpu::Buffer*> lists =
      context.has("triangle_ids") ? context.grown("triangle_ids") : std::vector<const gpu::Buffer*>{};
  const std::array<gpu::BoundResource, 18> rest = {
      context.buffer("scene.triangle_materials"),
      context.buffer("scene.materials"),
      context.buffer("scene.textures"),
      context.buffer("occupancy"),
      context.buffer("rank"),
      context.buffer("mask"),
      context.buffer("first"),
      context.buffer("area_sums"),
      context.buffer("albedo_sums"),
      context.buffer("position_sums"),
      context.buffer("normal_sums"),
      emissive_ ? context.buffer("emission_sums") : context.buffer("area_sums"),
      peak,
      context.buffer("voxel_areas"),
      normals_ == Normals::Heuristic ? context.buffer("angle_sums") : context.buffer("area_sums"),
      context.buffer("footprints"),
      context.buffer(lists.empty() ? "area_sums" : "triangle_first"),
      lists.empty() ? context.buffer("area_sums") : *lists.front()};
  pass_.record(context, grid, rest);
}

void Surface::resolveFaces(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const auto voxelCount = static_cast<uint32_t>(context.count("voxels"));
  const gpu::Buffer& area = context.buffer("area_sums");
  const gpu::Buffer& faces = context.buffer("faces");
  commands.bind(resolve_,
                {context.buffer("grid"), context.buffer("occupancy"), context.buffer("voxels"), context.buffer("mask"),
                 context.buffer("first"), area, context.buffer("albedo_sums"), context.buffer("position_sums"),
                 context.buffer("normal_sums"), emissive_ ? context.buffer("emission_sums") : area, context.buffer("emission_peak"),
                 context.buffer("voxel_areas"), normals_ == Normals::Heuristic ? context.buffer("angle_sums") : area, faces,
                 wantsEmission_ ? context.buffer("emission") : faces, context.buffer("check_words"), context.buffer("footprints")});
  commands.push(voxelCount);
  commands.dispatchItems(voxelCount, 64);
}

void Surface::frameDone(graph::RecordContext& context) {
  Check check{};
  std::memcpy(&check, context.buffer("check").mapped(), sizeof(check));
  const double area = check.areaHigh + check.areaLow / 4294967296.0;
  context.reportStat("total_area", area * check.h * check.h);
}

}  // namespace radivox::clustered_voxel
