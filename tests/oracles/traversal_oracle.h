// Voxel rays on the CPU, voxel by voxel: what clustered_voxel.visibility must find, bit for bit. It only steps (no leaps over empty
// space), so it also says what leaping must not change. Definitions: shaders/shared/traversal.glsl and voxel_cast.glsl.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <vector>

#include "tests/oracles/voxel_structures.h"

namespace radivox::oracle {

struct VisibilitySettings {
  uint32_t rays = 128;
  bool bresenham = false;
  bool axisFrame = false;
  bool voxelHit = false;
  float near = 8.f;
  bool skyImage = false;  ///< misses by finer bins
};

struct VoxelVisit {
  glm::ivec3 voxel;
  float entry, exit;  ///< distance along the ray
};
/// Every voxel of the grid that the ray touches from `start` on, in order, until `visit` returns false or the grid ends.
/// Returns whether it was stopped.
bool walkVoxels(const glm::uvec3& size, const glm::vec3& origin, const glm::vec3& direction, const glm::ivec3& start,
                const std::function<bool(const VoxelVisit&)>& visit);
/// The voxel where a ray enters the grid (that of its origin inside); false: never.
bool enterGrid(const glm::uvec3& size, const glm::vec3& origin, const glm::vec3& direction, glm::ivec3& voxel, float& time);
/// Bresenham's line in closed form: the voxels after `start` (not included) until the grid ends.
std::vector<glm::ivec3> bresenhamLine(const glm::uvec3& size, const glm::ivec3& start, const glm::vec3& direction);

constexpr uint32_t kOracleMiss = 0xffffffffu;      // RayResult::face
constexpr uint32_t kOracleAbsorbed = 0xfffffffeu;  // stopped by the back of a one-sided surface
struct RayResult {
  uint32_t face = kOracleMiss;
  float distance = 0.f;
  glm::vec3 direction{0.f};
};
/// Ray `ray` of face `face`; `directions` as makeDirections() gives them.
RayResult traceFaceRay(const VoxelStructures& structures, const VisibilitySettings& settings, const std::vector<uint32_t>& directions,
                       uint32_t face, uint32_t ray);

/// id → count of each face (shaders/shared/voxel.h: clusters, near faces, misses by bin, kAbsorbed).
std::vector<std::map<uint32_t, uint32_t>> visibilityRows(const VoxelStructures& structures, const VisibilitySettings& settings,
                                                         const std::vector<uint32_t>& labels, uint32_t clusterCount);

/// Σ round(64 a_r) over the rays of all faces r that hit each face from beyond 2 voxels.
std::vector<uint32_t> seenWeights(const VoxelStructures& structures, const VisibilitySettings& settings);

/// First triangle along the ray within (0, ∞), by trying them all; −1: none. Double precision.
int castTriangles(const Soup& soup, const glm::dvec3& origin, const glm::dvec3& direction, double* distance = nullptr);

}  // namespace radivox::oracle
