// The voxel grid of a scene: the one place that decides origin, voxel edge and size. On the host, in double.
#pragma once

#include "engine/scene/traits.h"
#include "shaders/shared/voxel.h"

namespace radivox::clustered_voxel {

/// N voxels along the longest side of the bounds: h = longest / (N − 1), size_k = ceil(extent_k / h) + 1, centred on the bounds, so at
/// least half a voxel is free on every side. A single point, or bounds without extent, give one voxel of 1 m.
shared::Grid makeGrid(const glm::vec3& boundsMin, const glm::vec3& boundsMax, uint32_t resolution);
shared::Grid makeGrid(const scene::Traits& traits, uint32_t resolution);

/// Same, but throws OutOfMemory when the occupancy bits do not fit `maxStorageBufferRange` (0: no limit), naming the largest resolution
/// that fits. `owner` is the parameter as the user writes it.
shared::Grid makeGridWithin(const scene::Traits& traits, uint32_t resolution, uint64_t maxStorageBufferRange, const char* owner);

}  // namespace radivox::clustered_voxel
