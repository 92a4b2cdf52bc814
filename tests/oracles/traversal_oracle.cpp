#include "tests/oracles/traversal_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"

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

/// The octahedral direction before it is made a unit vector.
vec3 planeNormal(uint32_t code) {
  float x = static_cast<float>(static_cast<int16_t>(code & 0xffffu)) * (1.0f / 32767.0f);
  float y = static_cast<float>(static_cast<int16_t>(code >> 16)) * (1.0f / 32767.0f);
  const float z = 1.0f - std::fabs(x) - std::fabs(y);
  if (z < 0.f) {
    x += x >= 0.f ? z : -z;
    y += y >= 0.f ? z : -z;
  }
  return {x, y, z};
}

/// A voxel's surface as a ray sees it along one axis.
struct Candidate {
  uint32_t face = shared::kNone;
  bool front = false;  ///< false: the back of a face that looks the other way
  uint32_t facing = 0;
  float weight = 0.f;
};

struct Caster {
  const VoxelStructures& s;
  bool voxelHit;
  vec3 origin, direction;

  std::vector<Candidate> candidates(uint32_t voxel, uint32_t excluded) const {
    std::vector<Candidate> all;
    for (uint32_t k = 0; k < 3; ++k) {
      const float d = std::fabs(direction[k]) < kFlat ? 0.f : direction[k];
      if (d == 0.f) continue;
      const uint32_t facing = 2 * k + (d > 0.f ? 1 : 0);
      const bool front = s.hasFace(voxel, facing);
      const uint32_t f = front ? facing : facing ^ 1u;
      if (!s.hasFace(voxel, f) || ((excluded >> f) & 1u) != 0) continue;
      const uint32_t face = s.faceIndex(voxel, f);
      all.push_back({face, front, facing, s.faces[face].area * std::fabs(d)});
    }
    return all;
  }

  bool covers(const Candidate& c, const vec3& mean, const vec3& center, const vec3& in, const vec3& out, float before, float behind) const {
    const shared::Face& face = s.faces[c.face];
    const uint32_t axis = c.facing >> 1;
    vec3 sides(1.f), reach;
    for (uint32_t k = 0; k < 3; ++k) {
      reach[k] = std::min(mean[k], 1.0f - mean[k]);
      if (k != axis) sides[k] = 2.0f * reach[k];
    }
    if (face.area > 0.95f || sides.x * sides.y * sides.z < 0.98f * face.area) return true;
    const float whole = before + behind;
    for (uint32_t k = 0; k < 3; ++k) {
      if (k == axis) continue;
      const float offset = (in[k] - center[k]) * whole + (out[k] - in[k]) * before;
      if (std::fabs(offset) > (reach[k] + 0.05f) * whole) return false;
    }
    return true;
  }

  /// kOracleMiss: the ray goes on.
  uint32_t cast(const VoxelVisit& visit, uint32_t excluded, uint32_t& inFront, uint32_t random) const {
    const uint32_t was = inFront;
    inFront = 0;
    const uint32_t voxel = s.voxelIndex(visit.voxel);
    if (voxel == shared::kNone) return kOracleMiss;
    const vec3 in = origin + visit.entry * direction, out = origin + visit.exit * direction;
    std::array<Candidate, 3> hits{};
    bool back = false;
    for (const Candidate& c : candidates(voxel, excluded)) {
      bool hit = true;
      if (!voxelHit) {
        const vec3 mean = shared::decodePosition(s.faces[c.face].position);
        const vec3 center = vec3(visit.voxel) + mean;
        const vec3 n = planeNormal(s.faces[c.face].normal) * (c.front ? 1.f : -1.f);
        const float before = dot(in - center, n), after = dot(out - center, n);
        if (after >= -1e-3f) inFront |= 1u << c.facing;
        const bool cameFromFront = before >= 0.f || ((was >> c.facing) & 1u) != 0;
        hit = dot(direction, n) < 0.f && after <= 0.f && cameFromFront && covers(c, mean, center, in, out, std::max(before, 0.f), -after);
      }
      if (!hit) continue;
      if (c.front) {
        hits[c.facing >> 1] = c;
      } else {
        back = true;
      }
    }
    const float two = hits[0].weight + hits[1].weight;
    const float total = two + hits[2].weight;
    if (!(total > 0.f)) return back ? kOracleAbsorbed : kOracleMiss;
    const float draw = static_cast<float>(random >> 8) * (1.0f / 16777216.0f) * total;
    if (draw < hits[0].weight) return hits[0].face;
    if (draw >= two && hits[2].weight > 0.f) return hits[2].face;
    return hits[1].weight > 0.f ? hits[1].face : hits[0].face;
  }
};

/// Faces of the voxel on the plane through `position`.
uint32_t ownFaces(const VoxelStructures& s, uint32_t voxel, const vec3& position, const vec3& normal) {
  uint32_t own = 0;
  for (uint32_t f = 0; f < shared::kFaceCount; ++f) {
    if (!s.hasFace(voxel, f)) continue;
    const uint32_t face = s.faceIndex(voxel, f);
    const bool onPlane = std::fabs(dot(s.facePosition(face) - position, normal)) < 0.25f;
    if (onPlane && std::fabs(dot(shared::decodeNormal(s.faces[face].normal), normal)) > 0.82f) own |= 1u << f;
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

RayResult traceFaceRay(const VoxelStructures& s, const VisibilitySettings& settings, const std::vector<vec3>& directions, uint32_t face,
                       uint32_t ray) {
  const uint32_t key = s.faces[face].key;
  const glm::uvec3 coordinate = s.voxelCoordinate(key >> 3);
  const vec3 position = s.facePosition(face);
  const vec3 axis = shared::faceVector(key & 7u);
  const vec3 n = settings.axisFrame ? axis : shared::decodeNormal(s.faces[face].normal);
  const vec3 local = directions[shared::rotationOf(face) * settings.rays + ray];
  vec3 direction = shared::alongNormal(local, n);
  for (int k = 0; k < 3; ++k) direction[k] = std::fabs(direction[k]) < kFlat ? 0.f : direction[k];
  const uint32_t random = shared::rayRandom(face, ray);
  const ivec3 own(coordinate);
  const ivec3 start = settings.axisFrame ? own + ivec3(axis) : own;
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

  const vec3 origin = settings.axisFrame ? vec3(coordinate) + 0.5f + 0.5f * axis : shared::liftedOrigin(position, n, coordinate);
  const Caster caster{s, settings.voxelHit, origin, direction};
  const uint32_t excluded = settings.voxelHit ? 0x3fu : ownFaces(s, key >> 3, position, n);
  walkVoxels(s.grid.size, origin, direction, start, [&](const VoxelVisit& visit) {
    const bool atOwn = !settings.axisFrame && visit.voxel == own;
    result.face = caster.cast(visit, atOwn ? excluded : 0u, inFront, random);
    result.distance = visit.entry;
    return result.face == kOracleMiss;
  });
  return result;
}

std::vector<std::map<uint32_t, uint32_t>> visibilityRows(const VoxelStructures& s, const VisibilitySettings& settings,
                                                         const std::vector<uint32_t>& labels, uint32_t clusterCount) {
  const std::vector<vec3> directions = clustered_voxel::makeDirections(settings.rays);
  std::vector<std::map<uint32_t, uint32_t>> rows(s.faces.size());
  for (uint32_t face = 0; face < s.faces.size(); ++face) {
    for (uint32_t ray = 0; ray < settings.rays; ++ray) {
      const RayResult r = traceFaceRay(s, settings, directions, face, ray);
      uint32_t id = 0;
      if (r.face == kOracleMiss) {
        id = shared::kMissBase + shared::directionBin(r.direction);
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
