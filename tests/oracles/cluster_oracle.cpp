#include "tests/oracles/cluster_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <set>
#include <tuple>

namespace radivox::oracle {
namespace {

using shared::kNone;

struct Seed {
  glm::ivec3 home{0};
  glm::vec3 position{0.f};
  glm::vec3 normal{0.f};
};

uint32_t dominantDirection(const glm::vec3& n) {
  uint32_t axis = 0;
  for (uint32_t k = 1; k < 3; ++k)
    if (std::abs(n[static_cast<int>(k)]) > std::abs(n[static_cast<int>(axis)])) axis = k;
  return axis * 2 + (n[static_cast<int>(axis)] < 0.f ? 1 : 0);
}

/// The clustering of one scene, step by step.
class Clustering {
 public:
  Clustering(const VoxelStructures& structures, const ClusterSettings& settings) : s_(structures), settings_(settings) {
    const double angle = static_cast<double>(settings.angleDegrees) * std::numbers::pi / 180.0;
    const double spacing = settings.spacing;
    spaceScale_ = static_cast<float>(static_cast<double>(settings.spaceWeight) / (spacing * spacing));
    normalScale_ = static_cast<float>(static_cast<double>(settings.normalWeight) / (1.0 - std::cos(angle)));
    cosAngle_ = static_cast<float>(std::cos(angle));
    bins_ = std::ceil(std::numbers::sqrt2 / std::tan(0.5 * angle) + 1e-3);
    const double members = std::min(162.0 * spacing * spacing * spacing, static_cast<double>(faceCount()));
    while (members * ((1.5 * spacing + 1.0) * 1023.0 / std::exp2(shift_) + 1.0) >= 2147483648.0) ++shift_;
    double unit = 32767.0;
    while (members * (unit + 1.0) >= 2147483648.0) unit *= 0.5;
    normalUnit_ = static_cast<float>(unit);
    for (uint32_t i = 0; i < faceCount(); ++i) {
      voxel_.push_back(glm::ivec3(s_.voxelCoordinate(s_.faces[i].key >> 3)));
      position_.push_back(s_.facePosition(i));
      normal_.push_back(shared::decodeNormal(s_.faces[i].normal));
      cell_.push_back(voxel_.back() / static_cast<int>(settings.spacing));
    }
  }

  ClusterResult run() {
    plantSeeds();
    for (uint32_t i = 0; i < settings_.iterations; ++i) {
      moveSeeds();
      const uint32_t changed = assign();
      ++result_.iterations;
      if (changed <= static_cast<uint32_t>(static_cast<double>(settings_.stopFraction) * faceCount())) break;
    }
    result_.orphanCount = static_cast<uint32_t>(std::count(label_.begin(), label_.end(), kNone));
    findPieces();
    for (int round = 0; round < 4 && settings_.merge > 0; ++round) mergePieces();
    numberClusters();
    return result_;
  }

 private:
  uint32_t faceCount() const { return static_cast<uint32_t>(s_.faces.size()); }

  void plantSeeds() {
    // Cells in order of their lowest face; seeds in order of cell, then direction.
    std::map<std::tuple<int, int, int>, uint32_t> cells;
    std::vector<std::set<uint32_t>> directions;
    for (uint32_t i = 0; i < faceCount(); ++i) {
      const auto [place, isNew] = cells.try_emplace({cell_[i].x, cell_[i].y, cell_[i].z}, static_cast<uint32_t>(cells.size()));
      if (isNew) directions.emplace_back();
      directions[place->second].insert(dominantDirection(normal_[i]));
    }
    std::vector<std::map<uint32_t, uint32_t>> seedOf(directions.size());
    for (size_t c = 0; c < directions.size(); ++c)
      for (uint32_t d : directions[c]) {
        seedOf[c][d] = static_cast<uint32_t>(seeds_.size());
        seeds_.emplace_back();
      }
    for (uint32_t i = 0; i < faceCount(); ++i) {
      const uint32_t seed = seedOf[cells.at({cell_[i].x, cell_[i].y, cell_[i].z})].at(dominantDirection(normal_[i]));
      label_.push_back(seed);
      seeds_[seed].home = cell_[i];
    }
    for (uint32_t i = 0; i < seeds_.size(); ++i) seedsAt_[key(seeds_[i].home)].push_back(i);
    result_.seedCount = static_cast<uint32_t>(seeds_.size());
  }

  static std::tuple<int, int, int> key(const glm::ivec3& c) { return {c.x, c.y, c.z}; }

  void moveSeeds() {
    const int spacing = static_cast<int>(settings_.spacing);
    std::vector<std::array<int64_t, 7>> sums(seeds_.size());
    for (uint32_t i = 0; i < faceCount(); ++i) {
      if (label_[i] == kNone) continue;
      auto& sum = sums[label_[i]];
      const uint32_t code = s_.faces[i].position;
      const glm::ivec3 inside(code & 1023, (code >> 10) & 1023, (code >> 20) & 1023);
      for (int k = 0; k < 3; ++k) {
        const int offset = voxel_[i][k] * 1023 + inside[k] - middle(seeds_[label_[i]].home[k], spacing);
        sum[static_cast<size_t>(k)] += static_cast<int64_t>(std::floor(offset / std::exp2(shift_) + (shift_ > 0 ? 0.5 : 0.0)));
        sum[static_cast<size_t>(k + 3)] += static_cast<int64_t>(std::floor(normal_[i][k] * normalUnit_ + 0.5f));
      }
      ++sum[6];
    }
    for (size_t j = 0; j < seeds_.size(); ++j) {
      const auto& sum = sums[j];
      if (sum[6] == 0) continue;
      const float share = shared::preciseReciprocal(static_cast<float>(sum[6])) * static_cast<float>(std::exp2(shift_));
      glm::vec3 direction(0.f);
      for (int k = 0; k < 3; ++k) {
        const float m = static_cast<float>(middle(seeds_[j].home[k], spacing));
        seeds_[j].position[k] = (m + static_cast<float>(sum[static_cast<size_t>(k)]) * share) * (1.f / 1023.f);
        direction[k] = static_cast<float>(sum[static_cast<size_t>(k + 3)]);
      }
      const float squared = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
      if (squared >= 1.f) seeds_[j].normal = direction * shared::preciseInverseSqrt(squared);
    }
  }
  static int middle(int cell, int spacing) { return cell * spacing * 1023 + spacing * 1023 / 2; }

  float cosineTo(uint32_t face, const Seed& seed) const {
    const glm::vec3 &a = normal_[face], &b = seed.normal;
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  float distanceTo(uint32_t face, const Seed& seed) const {
    const glm::vec3 o = position_[face] - seed.position;
    return (o.x * o.x + o.y * o.y + o.z * o.z) * spaceScale_ + (1.f - cosineTo(face, seed)) * normalScale_;
  }
  bool accepts(const Seed& seed, uint32_t face) const { return cosineTo(face, seed) >= cosAngle_; }

  uint32_t assign() {
    uint32_t changed = 0;
    for (uint32_t i = 0; i < faceCount(); ++i) {
      uint32_t best = kNone;
      float bestDistance = std::numeric_limits<float>::infinity();
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const auto found = seedsAt_.find(key(cell_[i] + glm::ivec3(x, y, z)));
            if (found == seedsAt_.end()) continue;
            for (uint32_t seed : found->second) {
              if (!accepts(seeds_[seed], i)) continue;
              const float d = distanceTo(i, seeds_[seed]);
              if (d < bestDistance || (d == bestDistance && seed < best)) {
                best = seed;
                bestDistance = d;
              }
            }
          }
      if (best != label_[i]) ++changed;
      label_[i] = best;
    }
    return changed;
  }

  /// Which cut of the cube of directions a normal is in; orphans keep to one.
  std::array<double, 3> directionBin(uint32_t face) const {
    const uint32_t direction = dominantDirection(normal_[face]);
    const int axis = static_cast<int>(direction >> 1);
    std::array<double, 3> bin{static_cast<double>(direction), 0, 0};
    const float scale = shared::preciseReciprocal(std::abs(normal_[face][axis]));
    int j = 1;
    for (int k = 0; k < 3; ++k) {
      if (k == axis) continue;
      const float u = (normal_[face][k] * scale + 1.f) * (0.5f * static_cast<float>(bins_));
      bin[static_cast<size_t>(j++)] = std::clamp(std::floor(static_cast<double>(u)), 0.0, bins_ - 1.0);
    }
    return bin;
  }
  bool belongTogether(uint32_t a, uint32_t b) const {
    if (label_[a] != label_[b]) return false;
    return label_[a] != kNone || (cell_[a] == cell_[b] && directionBin(a) == directionBin(b));
  }

  /// A face across axis k that one sees on the way from a to b, in the voxel of either: it looks back along the axis, and its place on the axis is
  /// between theirs. Where the voxel holds hardly any of it, that of the voxel next to it, on the side to which a looks, counts.
  bool seesWall(uint32_t a, uint32_t b) const {
    const uint32_t up = dominantDirection(normal_[a]);
    for (int k = 0; k < 3; ++k) {
      const float step = position_[b][k] - position_[a][k];
      if (std::abs(step) < 0.05f) continue;
      const uint32_t direction = static_cast<uint32_t>(2 * k) + (step > 0.f ? 1 : 0);
      for (const uint32_t at : {a, b}) {
        uint32_t wall = faceAt(voxel_[at], direction);
        if (wall == kNone) continue;
        glm::ivec3 ahead(0);
        ahead[static_cast<int>(up >> 1)] = (up & 1) != 0 ? -1 : 1;
        if (s_.faces[wall].area < 0.01f && static_cast<int>(up >> 1) != k) wall = faceAt(voxel_[at] + ahead, direction);
        if (wall == kNone || s_.faces[wall].area < 0.01f || std::abs(normal_[wall][k]) < 0.5f) continue;
        const float before = position_[a][k] - position_[wall][k], after = position_[b][k] - position_[wall][k];
        if (before * after <= 0.f) return true;
      }
    }
    return false;
  }
  bool areApart(uint32_t a, uint32_t b) const { return voxel_[a] != voxel_[b] && (seesWall(a, b) || seesWall(b, a)); }
  uint32_t faceAt(const glm::ivec3& coordinate, uint32_t direction) const {
    const uint32_t voxel = s_.voxelIndex(coordinate);
    if (voxel == kNone) return kNone;
    for (uint32_t i = s_.first[voxel]; i < s_.first[voxel + 1]; ++i)
      if ((s_.faces[i].key & 7) == direction) return i;
    return kNone;
  }

  void forNeighbours(uint32_t face, const std::function<void(uint32_t)>& visit) const {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const uint32_t other = s_.voxelIndex(voxel_[face] + glm::ivec3(x, y, z));
          if (other == kNone) continue;
          for (uint32_t b = s_.first[other]; b < s_.first[other + 1]; ++b)
            if (b != face) visit(b);
        }
  }

  void findPieces() {
    piece_.assign(faceCount(), kNone);
    for (uint32_t i = 0; i < faceCount(); ++i) {
      if (piece_[i] != kNone) continue;
      ++result_.pieceCount;
      std::queue<uint32_t> open;
      piece_[i] = i;
      open.push(i);
      while (!open.empty()) {
        const uint32_t a = open.front();
        open.pop();
        forNeighbours(a, [&](uint32_t b) {
          if (piece_[b] != kNone || !belongTogether(a, b) || areApart(a, b)) return;
          piece_[b] = i;
          open.push(b);
        });
      }
    }
  }

  Seed seedOfPiece(uint32_t piece) const {
    return label_[piece] != kNone ? seeds_[label_[piece]] : Seed{glm::ivec3(0), position_[piece], normal_[piece]};
  }

  void mergePieces() {
    std::map<uint32_t, std::vector<uint32_t>> members;
    for (uint32_t i = 0; i < faceCount(); ++i) members[piece_[i]].push_back(i);
    std::map<uint32_t, uint32_t> target;
    for (const auto& [piece, faces] : members) {
      if (faces.size() > settings_.merge) continue;
      std::set<uint32_t> candidates;
      for (uint32_t face : faces)
        forNeighbours(face, [&](uint32_t b) {
          if (!areApart(face, b)) candidates.insert(piece_[b]);
        });
      candidates.erase(piece);
      float least = std::numeric_limits<float>::infinity();
      for (uint32_t candidate : candidates) {
        const Seed seed = seedOfPiece(candidate);
        float distance = 0.f;
        for (uint32_t face : faces) distance = accepts(seed, face) ? distance + distanceTo(face, seed) : HUGE_VALF;
        if (distance < least) {
          least = distance;
          target[piece] = candidate;
        }
      }
    }
    std::map<uint32_t, uint32_t> link;
    for (const auto& [piece, to] : target) {
      const auto onward = target.find(to);
      if (onward == target.end() || (onward->second == piece && to < piece)) link[piece] = to;
    }
    result_.mergedCount += static_cast<uint32_t>(link.size());
    for (uint32_t& piece : piece_)
      if (const auto found = link.find(piece); found != link.end()) piece = found->second;
  }

  void numberClusters() {
    std::map<uint32_t, uint32_t> number;
    for (uint32_t piece : piece_) result_.labels.push_back(number.try_emplace(piece, static_cast<uint32_t>(number.size())).first->second);
    result_.clusterCount = static_cast<uint32_t>(number.size());
  }

  const VoxelStructures& s_;
  const ClusterSettings& settings_;
  float spaceScale_ = 0, normalScale_ = 0, cosAngle_ = 0, normalUnit_ = 0;
  double bins_ = 0;
  int shift_ = 0;
  std::vector<glm::ivec3> voxel_, cell_;
  std::vector<glm::vec3> position_, normal_;
  std::vector<Seed> seeds_;
  std::map<std::tuple<int, int, int>, std::vector<uint32_t>> seedsAt_;
  std::vector<uint32_t> label_, piece_;
  ClusterResult result_;
};

}  // namespace

ClusterResult clusterFaces(const VoxelStructures& structures, const ClusterSettings& settings) {
  return Clustering(structures, settings).run();
}

std::string checkClusters(const VoxelStructures& structures, const std::vector<uint32_t>& labels, uint32_t clusterCount,
                          float angleDegrees) {
  if (labels.size() != structures.faces.size()) return "labels and faces differ in number";
  uint32_t seen = 0;
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] > seen) return "face " + std::to_string(i) + " has label " + std::to_string(labels[i]) + " out of order";
    if (labels[i] == seen) ++seen;
  }
  if (seen != clusterCount) return std::to_string(seen) + " labels, " + std::to_string(clusterCount) + " clusters";

  std::vector<std::vector<uint32_t>> members(clusterCount);
  for (uint32_t i = 0; i < labels.size(); ++i) members[labels[i]].push_back(i);
  const double least = std::cos(2.0 * static_cast<double>(angleDegrees) * std::numbers::pi / 180.0) - 1e-4;
  for (uint32_t c = 0; c < clusterCount; ++c) {
    glm::dvec3 mean(0.0);
    std::map<uint32_t, std::vector<uint32_t>> byVoxel;
    for (uint32_t i : members[c]) {
      mean += static_cast<double>(structures.faces[i].area) * glm::dvec3(shared::decodeNormal(structures.faces[i].normal));
      byVoxel[structures.faces[i].key >> 3].push_back(i);
    }
    mean = glm::normalize(mean);
    for (uint32_t i : members[c])
      if (glm::dot(mean, glm::dvec3(shared::decodeNormal(structures.faces[i].normal))) < least)
        return "face " + std::to_string(i) + " looks another way than cluster " + std::to_string(c);
    // Flood fill over voxels: faces of one voxel touch each other.
    std::set<uint32_t> reached{byVoxel.begin()->first};
    std::queue<uint32_t> open({byVoxel.begin()->first});
    while (!open.empty()) {
      const glm::ivec3 at(structures.voxelCoordinate(open.front()));
      open.pop();
      for (int n = 0; n < 27; ++n) {
        const uint32_t other = structures.voxelIndex(at + glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1);
        if (other != kNone && byVoxel.contains(other) && reached.insert(other).second) open.push(other);
      }
    }
    if (reached.size() != byVoxel.size()) return "cluster " + std::to_string(c) + " is in pieces";
  }
  return {};
}

}  // namespace radivox::oracle
