#include "tests/oracles/voxel_structures.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "modules/clustered_voxel/voxelize/grid.h"
#include "tests/oracles/voxel_oracle.h"

namespace radivox::oracle {

namespace {

constexpr double kFixedUnit = 1.0 / 4294967296.0;  // areas below half of 2⁻³² h² do not exist on the device

struct FaceSum {
  double area = 0;
  glm::dvec3 albedo{0.0}, normal{0.0}, position{0.0}, emission{0.0};
  uint32_t across[2]{};  ///< slabs across the two axes that follow the face's
};

struct VoxelRange {
  glm::ivec3 low, high;
};

VoxelRange rangeOf(const Corners& corners, const shared::Grid& grid) {
  VoxelRange range{};
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({corners[0][k], corners[1][k], corners[2][k]});
    const double high = std::max({corners[0][k], corners[1][k], corners[2][k]});
    const int last = static_cast<int>(grid.size[k]) - 1;
    range.low[k] = std::clamp(static_cast<int>(std::floor(low)) - 1, 0, last);  // closed cubes: the one below may be touched
    range.high[k] = std::clamp(static_cast<int>(std::floor(high)), 0, last);
  }
  return range;
}

template <class Visit>
void forEachVoxel(const VoxelRange& range, Visit visit) {
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x) visit(glm::ivec3(x, y, z));
}

Corners gridCorners(const SoupTriangle& triangle, const shared::Grid& grid) {
  Corners corners;
  for (size_t i = 0; i < 3; ++i) corners[i] = glm::dvec3(shared::toGridSpace(grid, triangle.position[i]));
  return corners;
}

/// Halves a block of `edge` voxels that the triangle overlaps, down to single voxels. `margin` dilates every cube.
void fillBlock(VoxelStructures& s, const Corners& corners, const glm::ivec3& low, int edge, double margin) {
  if (glm::any(glm::greaterThanEqual(low, glm::ivec3(s.grid.size)))) return;
  if (!overlapsCube(corners, glm::dvec3(low) + 0.5 * edge, 0.5 * edge + margin)) return;
  if (edge == 1) {
    const uint32_t bit = shared::bitOf(glm::uvec3(low));
    glm::uvec2& word = s.occupancy[shared::brickOf(glm::uvec3(low), s.grid.bricks)];
    (bit < 32 ? word.x : word.y) |= 1u << (bit & 31);
    return;
  }
  for (int child = 0; child < 8; ++child)
    fillBlock(s, corners, low + edge / 2 * glm::ivec3(child & 1, (child >> 1) & 1, child >> 2), edge / 2, margin);
}

glm::dvec3 normalized(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

/// Shading normal at the polygon's centroid, on the geometric normal's side.
glm::dvec3 shadingNormal(const SoupTriangle& triangle, const Corners& corners, const glm::dvec3& centroid, const glm::dvec3& geometric) {
  const glm::dvec3 weights = barycentricOf(corners, centroid);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < 3; ++i) sum += weights[i] * glm::dvec3(triangle.normal[i]);
  if (glm::length(sum) < 1e-6) return geometric;
  const glm::dvec3 n = normalized(sum);
  return glm::dot(n, geometric) < 0.0 ? -n : n;
}

/// Sixteenths of the voxel's extent along `axis` (less 0.001 on both sides) that the polygon (relative to its voxel) passes.
uint32_t slabsAcross(const std::vector<glm::dvec3>& polygon, int axis) {
  uint32_t slabs = 0;
  for (int slab = 0; slab < 16; ++slab) {
    std::vector<glm::dvec3> part = clipByPlane(polygon, axis, slab / 16.0 + 0.001, 1.0);
    if (!part.empty()) part = clipByPlane(part, axis, (slab + 1) / 16.0 - 0.001, -1.0);
    if (!part.empty()) slabs |= 1u << slab;
  }
  return slabs;
}

uint32_t marginsOf(uint32_t u, uint32_t v) {
  if (u == 0 || v == 0) return 0;
  const auto low = [](uint32_t slabs) { return static_cast<uint32_t>(std::countr_zero(slabs)); };
  const auto high = [](uint32_t slabs) { return static_cast<uint32_t>(std::countl_zero(slabs << 16)); };
  return low(u) | high(u) << 4 | low(v) << 8 | high(v) << 12;
}

/// By voxel and direction: what shows its front there (both sides of double-sided triangles), and what shows its back.
struct FaceSums {
  std::map<uint32_t, FaceSum> fronts, backs;
};

void addTriangle(const SoupTriangle& triangle, const VoxelStructures& s, FaceSums& sums, std::vector<double>& voxelArea) {
  const Corners corners = gridCorners(triangle, s.grid);
  const glm::dvec3 geometric = normalized(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  forEachVoxel(rangeOf(corners, s.grid), [&](const glm::ivec3& voxel) {
    const glm::dvec3 low(voxel);
    if (!ownsPlane(corners, low)) return;
    const std::vector<glm::dvec3> polygon = clipToVoxel(corners, low);
    const double area = areaOf(polygon);
    const uint32_t index = s.voxelIndex(voxel);
    if (!(area > 0.0) || index == shared::kNone) return;
    voxelArea[index] += area;
    const glm::dvec3 centroid = centroidOf(polygon);
    std::vector<glm::dvec3> relative = polygon;
    for (glm::dvec3& p : relative) p -= low;
    const glm::dvec3 shading = shadingNormal(triangle, corners, centroid, geometric);
    for (uint32_t f = 0; f < shared::kFaceCount; ++f) {
      const double cosine = glm::dot(geometric, glm::dvec3(shared::faceVector(f)));
      const bool front = cosine > 0.0;
      const double weight = area * faceShare(geometric, static_cast<int>(f / 2), s.grid.dominant != 0);
      if (weight < 0.5 * kFixedUnit) continue;
      FaceSum& sum = (front || triangle.doubleSided ? sums.fronts : sums.backs)[index << 3 | f];
      sum.area += weight;
      sum.albedo += weight * glm::dvec3(triangle.albedo);
      sum.normal += weight * (front ? shading : -shading);
      sum.position += weight * (centroid - low);
      if (front) sum.emission += weight * glm::dvec3(triangle.emission);
      if (std::abs(cosine) < 0.25) continue;
      for (uint32_t i = 0; i < 2; ++i) sum.across[i] |= slabsAcross(relative, static_cast<int>((f / 2 + 1 + i) % 3));
    }
  });
}

}  // namespace

scene::Scene sceneOf(const Soup& soup) {
  scene::Scene scene;
  for (const SoupTriangle& triangle : soup) {
    shared::Material material{};
    material.albedo = triangle.albedo;
    material.alpha = 1.f;
    material.emission = triangle.emission;
    material.baseTexture = material.emissiveTexture = shared::kNoTexture;
    if (triangle.doubleSided) material.flags |= shared::kMaterialDoubleSided;
    if (triangle.emission != glm::vec3(0.f)) material.flags |= shared::kMaterialEmissive;
    scene.triangleMaterials.push_back(static_cast<uint32_t>(scene.materials.size()));
    scene.materials.push_back(material);
    scene.materialNames.push_back("material " + std::to_string(scene.materials.size()));
    for (int i = 0; i < 3; ++i) {
      shared::Vertex vertex{};
      vertex.position = triangle.position[i];
      vertex.normal = triangle.normal[i];
      scene.indices.push_back(static_cast<uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(vertex);
    }
  }
  if (soup.empty()) {
    scene.materials.emplace_back();
    scene.materialNames.emplace_back("none");
  }
  scene.cameras.emplace_back();
  return scene;
}

Soup soupOf(const scene::Scene& scene) {
  Soup soup(scene.triangleCount());
  for (size_t t = 0; t < soup.size(); ++t) {
    const shared::Material& material = scene.materials[scene.triangleMaterials[t]];
    for (size_t i = 0; i < 3; ++i) {
      const shared::Vertex& vertex = scene.vertices[scene.indices[3 * t + i]];
      soup[t].position[i] = vertex.position;
      soup[t].normal[i] = vertex.normal;
    }
    soup[t].albedo = material.albedo;
    soup[t].emission = material.emission;
    soup[t].doubleSided = (material.flags & shared::kMaterialDoubleSided) != 0;
  }
  return soup;
}

void addQuad(Soup& soup, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, const glm::vec3& albedo,
             const glm::vec3& emission) {
  const glm::vec3 normal = glm::normalize(glm::cross(u, v));
  SoupTriangle triangle;
  triangle.albedo = albedo;
  triangle.emission = emission;
  for (glm::vec3& n : triangle.normal) n = normal;
  triangle.position[0] = corner;
  triangle.position[1] = corner + u;
  triangle.position[2] = corner + u + v;
  soup.push_back(triangle);
  triangle.position[1] = corner + u + v;
  triangle.position[2] = corner + v;
  soup.push_back(triangle);
}

void addBox(Soup& soup, const glm::vec3& low, const glm::vec3& high, const glm::vec3& albedo, bool inward, const glm::vec3& emission) {
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    glm::vec3 u(0.f), v(0.f);
    u[b] = high[b] - low[b];
    v[c] = high[c] - low[c];
    for (const bool top : {false, true}) {
      glm::vec3 corner = low;
      if (top) corner[axis] = high[axis];
      const bool alongAxis = top != inward;  // u × v looks along +axis
      if (alongAxis) {
        addQuad(soup, corner, u, v, albedo, emission);
      } else {
        addQuad(soup, corner, v, u, albedo, emission);
      }
    }
  }
}

bool VoxelStructures::isInside(const glm::ivec3& voxel) const {
  return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) && glm::all(glm::lessThan(voxel, glm::ivec3(grid.size)));
}

bool VoxelStructures::isOccupied(const glm::ivec3& voxel) const {
  if (!isInside(voxel)) return false;
  return shared::hasBit(occupancy[shared::brickOf(glm::uvec3(voxel), grid.bricks)], shared::bitOf(glm::uvec3(voxel)));
}

uint32_t VoxelStructures::voxelIndex(const glm::ivec3& voxel) const {
  if (!isInside(voxel)) return shared::kNone;
  const uint32_t brick = shared::brickOf(glm::uvec3(voxel), grid.bricks), bit = shared::bitOf(glm::uvec3(voxel));
  return shared::hasBit(occupancy[brick], bit) ? rank[brick] + shared::countBitsBelow(occupancy[brick], bit) : shared::kNone;
}

uint32_t VoxelStructures::faceIndex(uint32_t voxel, uint32_t f) const {
  if (!hasFace(voxel, f)) return shared::kNone;
  return first[voxel] + static_cast<uint32_t>(std::popcount(mask[voxel] & ((1u << f) - 1u)));
}

void fillOccupancy(VoxelStructures& s, const Soup& soup, double half) {
  s.occupancy.assign(s.grid.brickCount, glm::uvec2(0));
  int rootEdge = 1;
  while (rootEdge < static_cast<int>(std::max({s.grid.size.x, s.grid.size.y, s.grid.size.z}))) rootEdge *= 2;
  for (const SoupTriangle& triangle : soup) fillBlock(s, gridCorners(triangle, s.grid), glm::ivec3(0), rootEdge, half - 0.5);
}

void indexVoxels(VoxelStructures& s) {
  const uint32_t brickCount = s.grid.brickCount;
  s.rank.assign(brickCount, 0);
  s.voxels.clear();
  std::vector<uint32_t> distance(brickCount, 255);
  std::deque<uint32_t> front;
  for (uint32_t brick = 0; brick < brickCount; ++brick) {
    s.rank[brick] = static_cast<uint32_t>(s.voxels.size());
    for (uint32_t bit = 0; bit < 64; ++bit)
      if (shared::hasBit(s.occupancy[brick], bit))
        s.voxels.push_back(shared::packVoxel(4u * shared::brickCoordinate(brick, s.grid.bricks) + shared::bitCoordinate(bit)));
    if (shared::countBits(s.occupancy[brick]) == 0) continue;
    distance[brick] = 0;
    front.push_back(brick);
  }
  // Breadth first over 26 neighbours is the Chebyshev distance.
  while (!front.empty()) {
    const uint32_t brick = front.front();
    front.pop_front();
    if (distance[brick] >= 254) continue;
    const glm::ivec3 at(shared::brickCoordinate(brick, s.grid.bricks));
    forEachVoxel({glm::max(at - 1, glm::ivec3(0)), glm::min(at + 1, glm::ivec3(s.grid.bricks) - 1)}, [&](const glm::ivec3& next) {
      const uint32_t id = static_cast<uint32_t>(next.x) +
                          s.grid.bricks.x * (static_cast<uint32_t>(next.y) + s.grid.bricks.y * static_cast<uint32_t>(next.z));
      if (distance[id] <= distance[brick] + 1) return;
      distance[id] = distance[brick] + 1;
      front.push_back(id);
    });
  }
  s.distance.assign((brickCount + 3) / 4, 0);
  for (uint32_t brick = 0; brick < brickCount; ++brick) s.distance[brick >> 2] |= distance[brick] << ((brick & 3) * 8);
}

void numberFaces(VoxelStructures& s) {
  s.first.assign(s.mask.size() + 1, 0);
  s.faces.clear();
  for (uint32_t voxel = 0; voxel < s.mask.size(); ++voxel) {
    s.first[voxel] = static_cast<uint32_t>(s.faces.size());
    for (uint32_t f = 0; f < shared::kFaceCount; ++f) {
      if (!s.hasFace(voxel, f)) continue;
      shared::Face face{};
      face.key = voxel << 3 | f;
      s.faces.push_back(face);
    }
  }
  s.first.back() = static_cast<uint32_t>(s.faces.size());
}

double faceShare(const glm::dvec3& normal, int k, bool dominant) {
  if (!dominant) return std::abs(normal[k]);
  // Lengths within 1e-4 of each other are equal; the first of those counts.
  int most = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) > 1.0001 * std::abs(normal[most])) most = axis;
  return k == most ? 1.0 : 0.0;
}

VoxelStructures buildVoxelStructures(const Soup& soup, uint32_t resolution, bool bothSides, bool dominant) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
  for (const SoupTriangle& triangle : soup)
    for (const glm::vec3& p : triangle.position) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  VoxelStructures s;
  s.grid = soup.empty() ? clustered_voxel::makeGrid(glm::vec3(0.f), glm::vec3(0.f), resolution)
                        : clustered_voxel::makeGrid(low, high, resolution);
  s.grid.dominant = dominant ? 1 : 0;
  fillOccupancy(s, soup);
  indexVoxels(s);
  FaceSums sums;
  s.voxelArea.assign(s.voxels.size(), 0.0);
  for (const SoupTriangle& triangle : soup) addTriangle(triangle, s, sums, s.voxelArea);
  std::set<uint32_t> madeOfBacks;
  if (bothSides) {  // backs only where there are no fronts
    for (const auto& [key, sum] : sums.backs)
      if (!sums.fronts.contains(key)) madeOfBacks.insert(key);
    sums.fronts.merge(sums.backs);
  }
  s.mask.assign(s.voxels.size(), 0);
  for (const auto& [key, sum] : sums.fronts) s.mask[key >> 3] |= 1u << (key & 7);
  numberFaces(s);
  for (shared::Face& face : s.faces) {
    const FaceSum& sum = sums.fronts.at(face.key);
    face.area = static_cast<float>(sum.area);
    const glm::dvec3 n = sum.normal / sum.area;
    face.normal = shared::encodeNormal(glm::length(n) < 1e-4 ? shared::faceVector(face.key & 7) : glm::vec3(glm::normalize(n)));
    face.position =
        shared::encodePosition(glm::vec3(sum.position / sum.area)) | (madeOfBacks.contains(face.key) ? shared::kMadeOfBacks : 0u);
    face.albedo = shared::withMargins(shared::encodeAlbedo(glm::vec3(sum.albedo / sum.area)), marginsOf(sum.across[0], sum.across[1]));
    s.emission.push_back(glm::vec3(sum.emission / sum.area * std::numbers::pi));
  }
  return s;
}

}  // namespace radivox::oracle
