#include "tests/oracles/traversal_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/voxel_plane.h"

namespace radivox::oracle {
namespace {

using glm::ivec3;
using glm::vec3;

constexpr float kFlat = 1e-6f;

struct Axis {
  float origin, direction, inverse;
  int step;
  /// Time of the crossing out of voxel coordinate v.
  float exit(int v) const { return (static_cast<float>(step > 0 ? v + 1 : v) - origin) * inverse; }
};

Axis makeAxis(float origin, float direction) {
  if (std::fabs(direction) < kFlat) return {origin, 0.f, 1e30f, 1};
  const float r = shared::preciseReciprocal(std::fabs(direction));
  return {origin, direction, direction < 0.f ? -r : r, direction < 0.f ? -1 : 1};
}

std::array<Axis, 3> makeAxes(const vec3& origin, const vec3& direction) {
  return {makeAxis(origin.x, direction.x), makeAxis(origin.y, direction.y), makeAxis(origin.z, direction.z)};
}

bool inside(const glm::uvec3& size, const ivec3& v) {
  for (int k = 0; k < 3; ++k) {
    if (v[k] < 0 || v[k] >= static_cast<int>(size[k])) return false;
  }
  return true;
}

int firstAxis(const std::array<Axis, 3>& axes, const ivec3& v) {
  int first = 0;
  for (int k = 1; k < 3; ++k) {
    if (axes[k].exit(v[k]) < axes[first].exit(v[first])) first = k;
  }
  return first;
}

float dot(const vec3& a, const vec3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

/// The face along axis k that a surface with normal n looks towards.
uint32_t facing(const vec3& n, uint32_t k) { return 2 * k + (n[k] < 0.f ? 1u : 0u); }

/// Faces of one voxel whose mean planes agree.
struct OraclePlane {
  uint32_t faces = 0;    ///< bit f: those that show their fronts
  uint32_t largest = 0;  ///< face index
  /// The normal that rays test: of the largest face, in 10 bits a coordinate, |x| + |y| + |z| = 1.
  vec3 normal(const VoxelStructures& s) const { return shared::planeNormal(shared::planeNormalCode(s.faces[largest].normal)); }
  /// normal·x on the plane, in 13 bits.
  float offset(const VoxelStructures& s) const {
    return shared::planeOffset(shared::encodePlaneOffset(normal(s), shared::decodePosition(s.faces[largest].position)));
  }
};

/// Largest face first; those on its plane join it.
std::vector<OraclePlane> planesOf(const VoxelStructures& s, uint32_t voxel) {
  std::vector<OraclePlane> planes;
  uint32_t left = s.mask[voxel];
  while (left != 0) {
    uint32_t founder = 6;
    for (uint32_t f = 0; f < 6; ++f) {
      if (((left >> f) & 1u) == 0) continue;
      if (founder == 6 || s.faces[s.faceIndex(voxel, f)].area > s.faces[s.faceIndex(voxel, founder)].area) founder = f;
    }
    OraclePlane plane;
    plane.largest = s.faceIndex(voxel, founder);
    const vec3 n = shared::decodeNormal(s.faces[plane.largest].normal), x = shared::decodePosition(s.faces[plane.largest].position);
    for (uint32_t f = 0; f < 6; ++f) {
      if (((left >> f) & 1u) == 0) continue;
      const shared::Face& face = s.faces[s.faceIndex(voxel, f)];
      const bool agrees = std::fabs(dot(shared::decodeNormal(face.normal), n)) > shared::kSamePlaneCosine &&
                          std::fabs(dot(shared::decodePosition(face.position) - x, n)) < shared::kSamePlaneDistance;
      if (f == founder || agrees) plane.faces |= 1u << f;
    }
    left &= ~plane.faces;
    // What is made of backs lies on the plane, but shows no surface there.
    for (uint32_t f = 0; f < 6; ++f) {
      const bool isMember = ((plane.faces >> f) & 1u) != 0;
      if (isMember && (s.faces[s.faceIndex(voxel, f)].position & shared::kMadeOfBacks) != 0) plane.faces &= ~(1u << f);
    }
    planes.push_back(plane);
  }
  return planes;
}

struct Caster {
  const VoxelStructures& s;
  bool voxelHit;
  vec3 origin, direction;  ///< flat components are 0

  /// Whether surface can be where the ray crosses the plane: `before` of `whole` of the way `passage` from `entry` (in the voxel) on.
  bool covers(uint32_t largest, const vec3& entry, const vec3& passage, float before, float whole) const {
    const shared::Face& face = s.faces[largest];
    const uint32_t axis = (face.key & 7u) >> 1;
    const uint32_t margins = shared::faceMargins(face);
    for (uint32_t i = 0; i < 2; ++i) {
      const uint32_t k = (axis + 1 + i) % 3;
      const float across = entry[k] * whole + passage[k] * before;  // times whole
      const auto low = static_cast<float>((margins >> (8 * i)) & 15u), high = static_cast<float>((margins >> (8 * i + 4)) & 15u);
      if (across < (low * (1.f / 16.f) - 0.02f) * whole || across > ((1.f + 0.02f) - high * (1.f / 16.f)) * whole) return false;
    }
    return true;
  }

  /// kOracleMiss: the ray goes on. `own`: planes that do not count.
  uint32_t cast(const VoxelVisit& visit, uint32_t own, uint32_t& inFront, uint32_t random) const {
    const uint32_t was = inFront;
    inFront = 0;
    const uint32_t voxel = s.voxelIndex(visit.voxel);
    if (voxel == shared::kNone) return kOracleMiss;
    const vec3 in = origin + visit.entry * direction, passage = (origin + visit.exit * direction) - in;
    const bool dominant = s.grid.dominant != 0;
    uint32_t bit = 1;
    bool found = false;
    float bestBefore = 0.f, bestWhole = 0.f;
    vec3 bestNormal(0.f);
    uint32_t bestFaces = 0;
    for (const OraclePlane& plane : planesOf(s, voxel)) {
      const bool counts = (own & bit) == 0;
      bit *= 2;
      if (!counts) continue;
      vec3 n = plane.normal(s);
      const float sign = dot(direction, n) > 0.f ? -1.f : 1.f;
      n *= sign;
      const float offset = plane.offset(s) * sign;
      uint32_t looks = 0;
      for (uint32_t k = 0; k < 3; ++k) {
        const bool member = (plane.faces & (3u << (2 * k))) != 0;  // a face of this direction, or its back
        // What belongs to one face is seen by whoever is in front; a projection, by whoever the face looks at.
        if (member && (dominant || n[k] * direction[k] < 0.f)) looks |= 1u << facing(n, k);
      }
      float before = 0.f, whole = 1.f;
      bool hit = looks != 0;
      if (!voxelHit) {
        const vec3 entry = in - vec3(visit.voxel);
        before = dot(entry, n) - offset;
        const float after = dot(entry + passage, n) - offset;
        hit = hit && after <= 0.f && (before >= 0.f || (was & looks) != 0);
        if (after >= -1e-3f) inFront |= looks;
        before = std::max(before, 0.f);
        whole = before - after;
        hit = hit && covers(plane.largest, entry, passage, before, whole) && whole > 0.f;
      }
      if (hit && (!found || before * bestWhole < bestBefore * whole)) {
        found = true;
        bestBefore = before;
        bestWhole = whole;
        bestNormal = n;
        bestFaces = (plane.faces & looks) != 0 ? plane.faces & looks : s.mask[voxel] & looks;
      }
    }
    if (!found) return kOracleMiss;
    if (bestFaces == 0) return kOracleAbsorbed;
    float weight[3];
    for (uint32_t k = 0; k < 3; ++k) {
      const float size = std::fabs(bestNormal[k] * (dominant ? 1.f : direction[k]));
      weight[k] = ((bestFaces >> facing(bestNormal, k)) & 1u) != 0 ? size : 0.f;
    }
    const float two = weight[0] + weight[1];
    const float total = two + weight[2];
    const float draw = static_cast<float>(random >> 8) * (1.0f / 16777216.0f) * total;
    uint32_t k = weight[1] > 0.f ? 1 : 0;
    if (draw < weight[0]) {
      k = 0;
    } else if (draw >= two && weight[2] > 0.f) {
      k = 2;
    }
    return s.faceIndex(voxel, facing(bestNormal, k));
  }
};

/// Planes of the voxel that lie on the plane through `position`, bit by bit in order.
uint32_t ownPlanes(const VoxelStructures& s, uint32_t voxel, const vec3& position, const vec3& normal) {
  uint32_t own = 0, bit = 1;
  for (const OraclePlane& plane : planesOf(s, voxel)) {
    const vec3 n = plane.normal(s);
    const float distance = dot(position - vec3(s.voxelCoordinate(voxel)), n) - plane.offset(s);
    const bool onPlane = distance * distance < 0.25f * 0.25f * dot(n, n);
    const float along = dot(n, normal);
    if (onPlane && along * along > 0.82f * 0.82f * dot(n, n)) own |= bit;
    bit *= 2;
  }
  return own;
}

}  // namespace

bool walkVoxels(const glm::uvec3& size, const vec3& origin, const vec3& direction, const ivec3& start,
                const std::function<bool(const VoxelVisit&)>& visit) {
  const std::array<Axis, 3> axes = makeAxes(origin, direction);
  ivec3 v = start;
  float entry = 0.f;
  while (inside(size, v)) {
    const int k = firstAxis(axes, v);
    const float exit = axes[k].exit(v[k]);
    if (!visit({v, entry, exit})) return true;
    entry = exit;
    v[k] += axes[k].step;
  }
  return false;
}

bool enterGrid(const glm::uvec3& size, const vec3& origin, const vec3& direction, ivec3& voxel, float& time) {
  const std::array<Axis, 3> axes = makeAxes(origin, direction);
  voxel = ivec3(glm::floor(origin));
  time = 0.f;
  // Outside the grid there are voxels, too, all empty: step through them while each axis is inside or on its way.
  while (!inside(size, voxel)) {
    for (int k = 0; k < 3; ++k) {
      const bool before = voxel[k] < 0, beyond = voxel[k] >= static_cast<int>(size[k]);
      if ((before && (axes[k].direction <= 0.f)) || (beyond && axes[k].direction >= 0.f)) return false;
    }
    const int k = firstAxis(axes, voxel);
    time = axes[k].exit(voxel[k]);
    voxel[k] += axes[k].step;
  }
  return true;
}

std::vector<ivec3> bresenhamLine(const glm::uvec3& size, const ivec3& start, const vec3& direction) {
  const std::array<Axis, 3> axes = makeAxes(vec3(0.f), direction);
  int major = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(axes[k].direction) > std::fabs(axes[major].direction)) major = k;
  }
  const int reach = static_cast<int>(std::max({size.x, size.y, size.z}));
  ivec3 delta;
  for (int k = 0; k < 3; ++k) {
    delta[k] = static_cast<int>(std::floor(axes[k].direction * std::fabs(axes[major].inverse) * static_cast<float>(reach) + 0.5f));
  }
  std::vector<ivec3> line;
  for (int i = 1;; ++i) {
    ivec3 v;
    // The point of the ideal line nearest to the grid at step i, halves rounded away from the start.
    for (int k = 0; k < 3; ++k) v[k] = start[k] + (delta[k] < 0 ? -1 : 1) * ((2 * i * std::abs(delta[k]) + reach) / (2 * reach));
    if (!inside(size, v)) return line;
    line.push_back(v);
  }
}

RayResult traceFaceRay(const VoxelStructures& s, const VisibilitySettings& settings, const std::vector<uint32_t>& directions, uint32_t face,
                       uint32_t ray) {
  const uint32_t key = s.faces[face].key;
  const glm::uvec3 coordinate = s.voxelCoordinate(key >> 3);
  const uint32_t seed = shared::faceSeed(shared::packVoxel(coordinate), key & 7u);
  const vec3 position = s.facePosition(face);
  const vec3 axis = shared::faceVector(key & 7u);
  const vec3 n = settings.axisFrame ? axis : shared::decodeNormal(s.faces[face].normal);
  const vec3 local = shared::decodeDirection(directions[shared::shiftOf(seed) * settings.rays + ray]);
  vec3 direction = shared::alongNormal(local, n);
  for (int k = 0; k < 3; ++k) direction[k] = std::fabs(direction[k]) < kFlat ? 0.f : direction[k];
  const uint32_t random = shared::rayRandom(seed, ray);
  const ivec3 own(coordinate);
  ivec3 start = settings.axisFrame ? own + ivec3(axis) : own;
  RayResult result;
  result.direction = direction;
  uint32_t inFront = 0;

  if (settings.bresenham) {
    const Caster caster{s, true, vec3(0.f), direction};
    const vec3 a = glm::abs(direction);
    const float longest = std::max({a.x, a.y, a.z});
    std::vector<ivec3> line;
    if (settings.axisFrame && s.isInside(start)) line.push_back(start);
    if (s.isInside(start)) {
      for (const ivec3& v : bresenhamLine(s.grid.size, start, direction)) line.push_back(v);
    }
    for (size_t i = 0; i < line.size() && result.face == kOracleMiss; ++i) {
      result.face = caster.cast({line[i], 0.f, 0.f}, 0, inFront, random);
      result.distance = static_cast<float>(i + (settings.axisFrame ? 0 : 1)) * shared::preciseReciprocal(longest);
    }
    return result;
  }

  const vec3 origin = settings.axisFrame ? vec3(coordinate) + 0.5f + 0.5f * axis : shared::liftedOrigin(position, n);
  if (!settings.axisFrame && !settings.voxelHit) {
    start = glm::clamp(ivec3(glm::floor(origin)), ivec3(0), ivec3(s.grid.size) - 1);
  }
  const Caster caster{s, settings.voxelHit, origin, direction};
  uint32_t excluded = 0;
  if (settings.voxelHit) {
    excluded = 0x3fu;
  } else if (s.voxelIndex(start) != shared::kNone) {
    excluded = ownPlanes(s, s.voxelIndex(start), position, n);
  }
  walkVoxels(s.grid.size, origin, direction, start, [&](const VoxelVisit& visit) {
    const bool atOwn = !settings.axisFrame && visit.voxel == start;
    result.face = caster.cast(visit, atOwn ? excluded : 0u, inFront, random);
    result.distance = visit.entry;
    return result.face == kOracleMiss;
  });
  return result;
}

std::vector<std::map<uint32_t, uint32_t>> visibilityRows(const VoxelStructures& s, const VisibilitySettings& settings,
                                                         const std::vector<uint32_t>& labels, uint32_t clusterCount) {
  const std::vector<uint32_t> directions = clustered_voxel::makeDirections(settings.rays);
  std::vector<std::map<uint32_t, uint32_t>> rows(s.faces.size());
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    for (uint32_t ray = 0; ray < settings.rays; ++ray) {
      const RayResult r = traceFaceRay(s, settings, directions, face, ray);
      uint32_t id = 0;
      if (r.face == kOracleMiss) {
        id = shared::kMissBase + shared::skyBin(r.direction, settings.skyImage);
      } else if (r.face == kOracleAbsorbed) {
        id = shared::kAbsorbed;
      } else {
        id = r.distance <= settings.near ? clusterCount + r.face : labels[r.face];
      }
      ++rows[face][id];
    }
  }
  return rows;
}

std::vector<uint32_t> seenWeights(const VoxelStructures& s, const VisibilitySettings& settings) {
  const std::vector<uint32_t> directions = clustered_voxel::makeDirections(settings.rays);
  std::vector<uint32_t> weights(s.faces.size());
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    for (uint32_t ray = 0; ray < settings.rays; ++ray) {
      const RayResult r = traceFaceRay(s, settings, directions, face, ray);
      if (r.face < s.faces.size() && r.distance > 2.f) weights[r.face] += static_cast<uint32_t>(s.faces[face].area * 64.f + 0.5f);
    }
  }
  return weights;
}

int castTriangles(const Soup& soup, const glm::dvec3& origin, const glm::dvec3& direction, double* distance) {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < soup.size(); ++i) {
    const glm::dvec3 a(soup[i].position[0]), e1 = glm::dvec3(soup[i].position[1]) - a, e2 = glm::dvec3(soup[i].position[2]) - a;
    const glm::dvec3 p = glm::cross(direction, e2);
    const double det = glm::dot(e1, p);
    if (std::fabs(det) < 1e-30) continue;
    const glm::dvec3 t = (origin - a) / det;
    const double u = glm::dot(t, p);
    const glm::dvec3 q = glm::cross(t, e1);
    const double v = glm::dot(direction, q), w = glm::dot(e2, q);
    if (u < 0 || v < 0 || u + v > 1 || w <= 0 || w >= nearest) continue;
    nearest = w;
    best = static_cast<int>(i);
  }
  if (distance != nullptr) *distance = nearest;
  return best;
}

}  // namespace radivox::oracle
