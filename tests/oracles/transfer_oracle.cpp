// Members, form factors and radiosity of cluster_oracle.h: sums as the definitions have them, in double.
#include <algorithm>
#include <cmath>

#include "shaders/shared/visibility_row.h"
#include "tests/oracles/cluster_oracle.h"

namespace radivox::oracle {

ClusterDescriptions describeClusters(const VoxelStructures& structures, const std::vector<uint32_t>& labels, uint32_t clusterCount) {
  struct Sum {
    glm::dvec3 position{0.0}, normal{0.0}, albedo{0.0};
    double area = 0;
    uint32_t count = 0;
  };
  std::vector<Sum> sums(clusterCount);
  for (uint32_t i = 0; i < labels.size(); ++i) {
    Sum& sum = sums[labels[i]];
    const shared::Face& face = structures.faces[i];
    const double a = face.area;
    sum.area += a;
    sum.position += a * glm::dvec3(structures.facePosition(i));
    sum.normal += a * glm::dvec3(shared::decodeNormal(face.normal));
    sum.albedo += a * glm::dvec3(shared::decodeAlbedo(face.albedo));
    ++sum.count;
  }
  ClusterDescriptions out{std::vector<shared::Cluster>(clusterCount + 1), std::vector<shared::ClusterPlace>(clusterCount)};
  uint32_t first = 0;
  for (uint32_t c = 0; c < clusterCount; ++c) {
    const Sum& sum = sums[c];
    out.places[c].position = glm::vec3(sum.position / sum.area);
    out.places[c].area = static_cast<float>(sum.area);
    out.places[c].normal = glm::vec3(glm::normalize(sum.normal));
    out.clusters[c].albedo = glm::vec3(sum.albedo / sum.area);
    out.clusters[c].firstMember = first;
    first += sum.count;
  }
  out.clusters[clusterCount].firstMember = first;
  return out;
}

std::vector<uint32_t> listMembers(const std::vector<uint32_t>& labels, uint32_t clusterCount) {
  std::vector<std::vector<uint32_t>> members(clusterCount);
  for (uint32_t i = 0; i < labels.size(); ++i) members[labels[i]].push_back(i);
  std::vector<uint32_t> all;
  for (const auto& list : members) all.insert(all.end(), list.begin(), list.end());
  return all;
}

PackedRows packRows(const VisibilityRows& rows, uint32_t idCount) {
  PackedRows packed;
  constexpr size_t kRows = shared::kRowsPerChunk;
  for (size_t begin = 0; begin < rows.size(); begin += kRows) {
    std::vector<bool> bits;
    for (size_t i = 0; i < kRows; ++i) {
      packed.rowStart.push_back(static_cast<uint32_t>(bits.size()));
      if (begin + i >= rows.size()) continue;
      uint32_t next = 0;
      for (const auto& [id, count] : rows[begin + i]) {
        const uint32_t code = shared::rowId(id, idCount);
        const glm::uvec2 entry = shared::encodeRowEntry(code - next, count);
        for (uint32_t k = 0; k < shared::rowEntryBits(code - next, count); ++k) bits.push_back(((entry[k / 32] >> (k % 32)) & 1) != 0);
        next = code + 1;
      }
    }
    packed.rowStart.push_back(static_cast<uint32_t>(bits.size()));
    std::vector<uint32_t> chunk((bits.size() + 31) / 32 + shared::kRowPadding);
    for (size_t k = 0; k < bits.size(); ++k) chunk[k / 32] |= (bits[k] ? 1u : 0u) << (k % 32);
    packed.chunks.push_back(std::move(chunk));
  }
  return packed;
}

SparseMatrix clusterTransfer(const VisibilityRows& rows, const std::vector<shared::Face>& faces, const std::vector<uint32_t>& labels,
                             uint32_t clusterCount) {
  SparseMatrix matrix;
  matrix.rows.resize(clusterCount);
  matrix.sky.resize(clusterCount);
  std::vector<double> area(clusterCount);
  for (size_t s = 0; s < faces.size(); ++s) area[labels[s]] += static_cast<double>(faces[s].area);
  for (size_t s = 0; s < faces.size(); ++s) {
    double rayCount = 0;
    for (const auto& [id, count] : rows[s]) rayCount += count;
    const uint32_t c = labels[s];
    for (const auto& [id, count] : rows[s]) {
      const double share = static_cast<double>(faces[s].area) * count / (rayCount * area[c]);
      if (id < clusterCount)
        matrix.rows[c][id] += share;
      else if (id < clusterCount + faces.size())
        matrix.rows[c][labels[id - clusterCount]] += share;
      else if (id < shared::kAbsorbed)
        matrix.sky[c] += share;
    }
  }
  return matrix;
}

std::vector<double> solveRadiosity(const SparseMatrix& matrix, const std::vector<double>& albedo, const std::vector<double>& source) {
  const size_t n = source.size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1));
  for (size_t i = 0; i < n; ++i) {
    for (const auto& [j, weight] : matrix.rows[i]) a[i][j] -= albedo[i] * weight;
    a[i][i] += 1.0;
    a[i][n] = source[i];
  }
  for (size_t k = 0; k < n; ++k) {
    size_t pivot = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      if (factor == 0.0) continue;
      for (size_t j = k; j <= n; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  std::vector<double> x(n);
  for (size_t k = n; k-- > 0;) {
    double sum = a[k][n];
    for (size_t j = k + 1; j < n; ++j) sum -= a[k][j] * x[j];
    x[k] = sum / a[k][k];
  }
  return x;
}

}  // namespace radivox::oracle
