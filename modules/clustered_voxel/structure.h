// The voxel structure that most stages look faces up in: ports and bindings 0…5, declared and bound the same way everywhere.
// GLSL side: shaders/clustered_voxel/structure.glsl.
#pragma once

#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

/// Reads grid, occupancy, rank, mask, first, faces, and voxels (not among the six bindings). Without `mask`, which planes hold too, it may be freed.
void declareStructure(graph::Declaration& d, bool mask = true);

/// Declares an optional read that is unwanted where no emitter lights by rays (Traits::emittersByRays).
void readEmission(graph::Declaration& d, const char* name, const char* meaning);

/// Binds the six, then `rest` from binding 6 on. `mask`: what lies at its binding, where the shader reads none.
void bindStructure(graph::RecordContext& context, const gpu::Pipeline& pipeline, std::initializer_list<gpu::BoundResource> rest,
                   const char* mask = "mask");

}  // namespace radivox::clustered_voxel
