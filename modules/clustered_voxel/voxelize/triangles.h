// clustered_voxel.triangles — which triangles meet each voxel: what rays test where voxels are too coarse.
//
// reads   scene.vertices, .indices, .triangle_materials, .materials; voxelize grid, occupancy; index rank, voxels
// writes  first  u32 × (V + 1)  first triangle of each voxel in ids
//         ids+   u32            triangles, ascending within a voxel, each with the faces of the voxel that its piece is no part of
//                               (shaders/shared/listed_triangle.h); publishes [triangle_entries]
//         pieces+ uvec2         middle (encodePosition) and area (float bits, h²) of each triangle's part in the voxel; made only if read
//         corners? uvec2 × 3T   corners of each triangle (shared/triangle_corners.h), 24 B; made only if read
// runs    when the geometry or the voxels change; host-paced in two steps, since the number of entries must be known to store them
// cost    two walks over the (triangle, voxel) pairs, a sort of short lists; 4 B an entry (about 5 entries a voxel of Sponza at N = 128)
// source  beyond the paper (METHODS section 1, "The receiver is where the error sits"): exact geometry for the first voxels of a ray
//
// A triangle is listed in every voxel whose closed cube it overlaps, so a ray that walks the grid meets it wherever it crosses it. Voxels with
// more than `most` triangles have an empty list: there planes of the mean surface serve better than a hundred tests.
//
// apart: where thin walls meet, one voxel face would be made of the inner side of one wall and of the outer side of the other, and carry the light of
// one to the other. Of each face the piece with the largest area · |n·e_f| leads; pieces more than 60 degrees from it leave the face
// where just one of the two reaches in front of the other's plane inside the voxel. (In a room's corner both do, on a block's neither.) A piece also
// leaves where another piece of the face, within 60 degrees of its direction, covers its middle inside the voxel, as a lamp does the ceiling right behind it.
// A piece that all its faces would lose stays in all; alpha-masked surface neither leads, covers nor leaves, nor does any in voxels of more than 64
// triangles. Faces (surface), rays that start and end on pieces (visibility, gather_pixels) and light that falls on them (inject) all go by it.
#pragma once

#include "modules/clustered_voxel/voxelize/triangle_pass.h"

namespace radivox::clustered_voxel {

/// Declares the input `corners`, wanted where one buffer holds the scene's; otherwise rays load vertices.
graph::Port& readCorners(graph::Declaration& d, bool wanted, const std::string& unwanted);

class Triangles : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.triangles";

  Triangles();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  uint32_t stepCount(graph::RecordContext&) override { return 2; }
  void record(graph::RecordContext& context) override;
  void stepDone(graph::RecordContext& context) override;

 private:
  TrianglePass::Method method_ = TrianglePass::Method::Auto;
  uint32_t most_ = 256;
  bool apart_ = true;
  bool hasPieces_ = false;  ///< somebody reads them, or sides are parted
  params::Table table_;
  TrianglePass count_, fill_;
  gpu::Pipeline limit_, sort_, pieces_, partSides_, corners_;
  std::unique_ptr<gpu::Scan> scan_;
};

}  // namespace radivox::clustered_voxel
