// Ray directions of clustered_voxel.visibility: low-discrepancy, cosine-weighted, in shifted sets that faces choose from by a hash.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace radivox::clustered_voxel {

/// kShiftCount sets of `rayCount` directions about +z, as shared::decodeDirection() reads them, one set after the other. Each set is a
/// golden-angle spiral on the unit disc, lifted to the hemisphere (Malley): every direction stands for the same share of
/// ∫ cosθ dω. The sets are one set shifted within a cell of its lattice: as different from each other as rotated ones, since a
/// lattice shifted by more is itself again, yet ray i goes nearly the same way in all of them, and neighbouring faces trace
/// together well.
std::vector<uint32_t> makeDirections(uint32_t rayCount);

}  // namespace radivox::clustered_voxel
