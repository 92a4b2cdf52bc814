// Ray directions of clustered_voxel.visibility: low-discrepancy, cosine-weighted, in rotations that faces choose by a hash.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace radivox::clustered_voxel {

/// kRotationCount sets of `rayCount` unit directions about +z, one set after the other. Each set is a golden-angle spiral on the unit
/// disc, lifted to the hemisphere (Malley): every direction stands for the same share of ∫ cosθ dω. Sets differ in azimuth and, within
/// each ray's stratum, in elevation, so that together they are a set of kRotationCount · rayCount.
std::vector<glm::vec3> makeDirections(uint32_t rayCount);

}  // namespace radivox::clustered_voxel
