// What voxelize, index, faces and surface make, on the CPU and from the definition: for tests of every later stage.
//   VoxelStructures s = buildVoxelStructures(soupOf(scene), 32);
// Upload s.occupancy, s.rank … as they are: layouts are those of the ports (docs/data_flow.md).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "engine/scene/scene.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::oracle {

/// One triangle with constant material. `position` in metres; `normal` unit shading normals, zero: the geometric one.
struct SoupTriangle {
  glm::vec3 position[3]{};
  glm::vec3 normal[3]{};
  glm::vec3 albedo{0.5f};
  glm::vec3 emission{0.f};  ///< L_e of the front side
  bool doubleSided = true;  ///< read only where bothSides is false
};
using Soup = std::vector<SoupTriangle>;

/// Materials' constant factors; textures and alpha masks are left out.
Soup soupOf(const scene::Scene& scene);
/// A scene of these triangles, a material each.
scene::Scene sceneOf(const Soup& soup);
/// Two triangles: corner, corner + u, corner + u + v, corner + v; the front looks along u × v.
void addQuad(Soup& soup, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, const glm::vec3& albedo = glm::vec3(0.5f),
             const glm::vec3& emission = glm::vec3(0.f));
/// The six walls of the cube [low, high], fronts inward or outward: a closed box of 12 triangles.
void addBox(Soup& soup, const glm::vec3& low, const glm::vec3& high, const glm::vec3& albedo, bool inward,
            const glm::vec3& emission = glm::vec3(0.f));

struct VoxelStructures {
  shared::Grid grid{};
  std::vector<glm::uvec2> occupancy;  ///< B
  std::vector<uint32_t> rank;         ///< B
  std::vector<uint32_t> voxels;       ///< V, packed coordinates
  std::vector<uint32_t> distance;     ///< ceil(B / 4) words of 4 bytes
  std::vector<uint32_t> mask;         ///< V
  std::vector<uint32_t> first;        ///< V + 1
  std::vector<shared::Face> faces;    ///< F
  std::vector<glm::vec3> emission;    ///< F; mean B_e = π L_e
  std::vector<double> voxelArea;      ///< V; Σ area of triangle ∩ voxel, h² (not a port)

  // Twins of shaders/shared/voxel_lookup.glsl.
  bool isInside(const glm::ivec3& voxel) const;
  bool isOccupied(const glm::ivec3& voxel) const;
  uint32_t voxelIndex(const glm::ivec3& voxel) const;  ///< kNone outside or free
  glm::uvec3 voxelCoordinate(uint32_t voxel) const { return shared::unpackVoxel(voxels[voxel]); }
  uint32_t brickDistance(uint32_t brick) const { return (distance[brick >> 2] >> ((brick & 3) * 8)) & 0xff; }
  bool hasFace(uint32_t voxel, uint32_t f) const { return ((mask[voxel] >> f) & 1) != 0; }
  uint32_t faceIndex(uint32_t voxel, uint32_t f) const;  ///< kNone when the voxel has no such face
  /// x_s of a face in grid space.
  glm::vec3 facePosition(uint32_t face) const { return shared::facePosition(faces[face], voxelCoordinate(faces[face].key >> 3)); }
};

/// `bothSides` as the parameter sides=both (true) or gltf (false), `dominant` as faces=dominant (true) or projected (false).
VoxelStructures buildVoxelStructures(const Soup& soup, uint32_t resolution, bool bothSides = true, bool dominant = false);
/// How much of the area of surface with this unit normal the faces along axis k get.
double faceShare(const glm::dvec3& normal, int k, bool dominant);

/// Sets the bit of every voxel of `structures.grid` whose closed cube of half edge `half` (0.5: the voxel) a triangle overlaps.
void fillOccupancy(VoxelStructures& structures, const Soup& soup, double half = 0.5);
/// rank, voxels, distance of given occupancy bits (for tests that make up their own voxels).
void indexVoxels(VoxelStructures& structures);
/// first of given masks; sizes `faces` and sets their keys.
void numberFaces(VoxelStructures& structures);

}  // namespace radivox::oracle
