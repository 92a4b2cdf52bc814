// The loop over (triangle, voxel) pairs that voxelize, faces and surface share. Three ways find columns of voxels along each triangle's
// dominant axis; one test (shaders/clustered_voxel/voxelize/triangle.glsl) decides, so all three meet the same pairs, each once:
//
//   hardware   conservative rasterization, a fragment a column (VK_EXT_conservative_rasterization)
//   geometry   the triangle dilated by half a pixel in a geometry shader and clipped to its bounds, a fragment a column
//   compute    a lane walks up to 16 columns; triangles are counted, scanned and cut into items, so that a wall as large as the grid
//              is thousands of items and not one lane
//
// cost    compute: one lane an item, 4·T bytes; raster: one vertex, or one geometry, shader run a triangle
// source  clustered_voxel_2022 section 4.1; Schwarz and Seidel 2010 (compute), Hasselgren et al. 2005 (dilation)
#pragma once

#include <span>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class TrianglePass {
 public:
  enum class Method : uint32_t { Auto, Hardware, Geometry, Compute };

  static params::Param methodParam(Method* method);
  /// Auto: compute, which on lavapipe is the fastest.
  static Method resolve(Method method) { return method == Method::Auto ? Method::Compute : method; }
  /// Stages that the bindings of a pass are used in.
  static uint32_t useOf(Method method) {
    return resolve(method) == Method::Compute ? uint32_t{graph::UseCompute} : uint32_t{graph::UseCompute} | graph::UseRaster;
  }

  /// Reads scene.vertices and scene.indices; scratch "items", "item_scan" and "item_arguments".
  static void declare(graph::Declaration& d, Method method);

  /// `stage` names shaders/clustered_voxel/voxelize/STAGE.comp and .frag; bindings 0…3 are the pass's own, `bindingCount` counts them all.
  /// Throws Unsupported when the device lacks what `method` needs; `owner` is the node's type.
  void prepare(gpu::Device& device, Method method, std::string_view owner, std::string_view stage, uint32_t bindingCount,
               const std::vector<gpu::SpecializationConstant>& constants);

  /// Meets every pair; `rest` goes to the bindings from 4 on. The caller places barriers before and after.
  void record(graph::RecordContext& context, const gpu::Buffer& grid, std::span<const gpu::BoundResource> rest) const;

 private:
  Method method_ = Method::Compute;
  gpu::Pipeline columns_, countItems_, itemArguments_;
  std::unique_ptr<gpu::Scan> scan_;
};

}  // namespace radivox::clustered_voxel
