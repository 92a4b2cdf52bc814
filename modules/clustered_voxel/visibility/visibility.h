// clustered_voxel.visibility — what each voxel face sees: form factors by counting rays.
//
// reads   grid; occupancy, distance (per brick); rank; voxels, mask, first (per voxel); faces; labels (cluster of each face)
//         triangle_first, triangle_ids, corners? of triangles and scene geometry (triangles > 0)
// takes   pieces?+ of triangles, which nobody else needs: freed at the end, and made again where this runs again
// frees   mask, where nobody reads it later: planes hold it
// writes  row_start u32 × chunks·(kRowsPerChunk + 1)  first bit of each row within its chunk
//         entries+ bits                               rows, a buffer a chunk: shared/visibility_row.h; the counts of a row sum to M
//         chunk_table uvec2 × chunks                  device address of each chunk
//         clearance+ u32 × voxels with a rim          empty box about each voxel (shared/clearance.h); none for skip=bricks, none
//         planes+ uvec2, plane_extras u32 × V         what rays are stopped by (shared/voxel_plane.h)
//         weights u32 × F                             Σ a over the rays that hit the face from beyond 2 h, in 1/64 h²; 0: nobody sees it
//         kept_even+, kept_odd+                        keep: what each ray hit, and hashes of voxels (kept_hits.h); one of the two, by turns
//         [entries]
// runs    when the scene, the voxels or the clusters change: host-paced, a chunk of kRowsPerChunk faces a step
// cost    M rays a face, each a few leaps of one word fetched and 2 looks at a voxel's faces; per chunk M + 2·2^⌈log2 M⌉ words a row
//         of scratch; about 14 bits an entry; four bytes a voxel of the grid (twice while it is made)
// source  METHODS section 1, Face visibility; traversal=bresenham, frame=axis and hit=voxel are the paper's (4.3)
//
// Directions are cosine-distributed about n_s, so m_{s,c} / M is the form factor, visibility included. With triangles, rays start on pieces of the
// face's surface, drawn by area and about the piece's own normal, and test the triangles of their first voxels (shaders/shared/voxel_walk.glsl): the
// mean point of a face often lies inside other surface. Without, they start at x_s, lifted by 0.05 h; which face stops a ray is told, with what was measured, in shaders/shared/voxel_cast.glsl. A hit nearer than
// `near` keeps its face's id, a farther one becomes its cluster's. Misses count by direction bin, backs of one-sided surfaces as
// kAbsorbed, so that rows always sum to M.
//
// Weights serve means over clusters (transfer, inject, bounce): in a closed scene a_r F_rs = a_s F_sr makes them M a_s, but of a face that others
// cover in part only what is seen of it counts, and a mean over areas would dim the cluster by what lies buried.
//
// Tracing, merging and filling are passes of their own, and rows are traced sorted by direction and by how many triangles their voxel has
// (sort_rows.comp): that, and the clearance bytes, are what makes it fast. Rows do not depend on either.
#pragma once

#include <chrono>
#include <memory>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"
#include "modules/clustered_voxel/visibility/kept_hits.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

class Visibility : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.visibility";
  enum class Traversal : uint32_t { Dda, Bresenham };
  enum class Frame : uint32_t { Normal, Axis };
  enum class Hit : uint32_t { Plane, Voxel };
  enum class Skip : uint32_t { Clearance, Bricks, None };
  enum class Weights : uint32_t { Seen, Area };
  Visibility();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  uint32_t stepCount(graph::RecordContext& context) override;
  void record(graph::RecordContext& context) override;
  void stepDone(graph::RecordContext& context) override;

 private:
  uint32_t chunkCount(graph::RecordContext& context) const;
  uint32_t rowCount(graph::RecordContext& context, uint32_t chunk) const;
  uint32_t firstTrace() const { return keep_ ? 2 : 1; }  ///< step
  bool usesClearance() const { return traversal_ == Traversal::Dda && skip_ == Skip::Clearance && !clearanceTooLarge_; }
  void begin(graph::RecordContext& context);
  void countPlanes(graph::RecordContext& context);
  void recordPlanes(graph::RecordContext& context);
  void recordClearance(graph::RecordContext& context);
  void recordTrace(graph::RecordContext& context, uint32_t chunk);
  void recordFill(graph::RecordContext& context, uint32_t chunk);

  uint32_t rays_ = 128;
  Traversal traversal_ = Traversal::Dda;
  Weights weights_ = Weights::Seen;
  Frame frame_ = Frame::Normal;
  Hit hit_ = Hit::Plane;
  Skip skip_ = Skip::Clearance;
  float near_ = 8.f;
  float triangles_ = 2.f;
  bool keep_ = false;
  params::Table table_;

  gpu::Pipeline countPlanes_, planes_, clearanceSums_[3], clearanceBoxes_, sortRows_, sortSome_, trace_, traceSome_, traceBricks_,
      traceSomeBricks_, merge_, fill_;
  KeptHits kept_;
  gpu::Buffer directions_;
  std::unique_ptr<gpu::Scan> scan_;
  shared::Grid grid_{};
  VkDeviceSize maxRange_ = 0;
  bool clearanceTooLarge_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace radivox::clustered_voxel
