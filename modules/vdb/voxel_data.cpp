#include "modules/vdb/voxel_data.h"

#include <algorithm>
#include <cassert>

#include "shaders/shared/id_colour.h"
#include "shaders/shared/visibility_row.h"

namespace radivox::vdb {

namespace {

bool isNamed(const Family& family, std::string_view name) { return name == family.name; }

/// Families whose voxel is that of its largest face: a mean of ids says nothing.
bool isOfLargestFace(const Family& family) { return std::string_view(family.name).rfind("cluster_", 0) == 0; }

bool hasBit(const std::vector<uint32_t>& bits, size_t i) { return ((bits[i / 32] >> (i % 32)) & 1u) != 0; }

}  // namespace

template <class T>
std::vector<T> VoxelData::download(const char* port, uint64_t count) const {
  if (count == 0) return {};
  const gpu::Buffer* buffer = buffers_.find(port);
  assert(buffer != nullptr && buffer->bytes() >= count * sizeof(T));
  return gpu::downloadAs<T>(*buffers_.device, *buffer, count);
}

VoxelData::VoxelData(Buffers buffers, bool faces) : buffers_(std::move(buffers)) {
  grid_ = download<shared::Grid>("grid", 1).at(0);
  voxels_ = download<uint32_t>("voxels", buffers_.voxelCount);
  if (!faces) return;
  mask_ = download<uint32_t>("mask", buffers_.voxelCount);
  first_ = download<uint32_t>("first", buffers_.voxelCount + 1);
  faces_ = download<shared::Face>("faces", buffers_.faceCount);
}

const char* VoxelData::findMissing(uint32_t needs) const {
  for (const Input& input : inputs()) {
    if (input.need != 0 && (input.need & needs) == 0) continue;
    const std::string_view port = input.port;
    const bool there = port == "entries" ? buffers_.find("row_start") != nullptr : buffers_.find(input.port) != nullptr;
    if (!there) return input.port;
  }
  return nullptr;
}

uint64_t VoxelData::bytes() const {
  return 4 * (voxels_.size() + mask_.size() + first_.size()) + sizeof(shared::Face) * faces_.size() +
         (rows_ ? 12 * rows_->misses.size() : 0);
}

uint64_t VoxelData::bytesToRead(const Family& family) const {
  const uint64_t item = family.kind == Kind::Vector ? 12 : 4;
  const uint64_t raw = isNamed(family, "indirect") ? 16 : item;  // irradiance comes with its alpha
  return (item + 1) * voxels_.size() + (item + 1 + raw) * faces_.size();
}

FamilyValues VoxelData::read(const Family& family, bool voxel, bool face) {
  FamilyValues values;
  const bool voxelsAlone = (family.needs & NeedFaces) == 0;
  if (voxel && voxelsAlone) readVoxelFamily(family, values);
  if (face || (voxel && !voxelsAlone)) {
    readFaceFamily(family, values);
    if (voxel && !voxelsAlone) summarize(family, values);
  }
  return values;
}

void VoxelData::readVoxelFamily(const Family& family, FamilyValues& values) {
  values.voxelActive.assign(voxels_.size(), 1);
  if (isNamed(family, "occupancy")) {
    values.voxel = std::vector<float>(voxels_.size(), 1.f);
  } else if (isNamed(family, "fragment_count")) {
    values.voxel = download<int32_t>("fragments", buffers_.voxelCount);
  } else {
    assert(isNamed(family, "mean_normal"));
    values.voxel = download<glm::vec3>("normals", buffers_.voxelCount);
  }
}

void VoxelData::readFaceFamily(const Family& family, FamilyValues& values) {
  const size_t count = faces_.size();
  values.faceActive.assign(count, 1);
  const auto make = [&](auto valueOf) {
    std::vector<decltype(valueOf(size_t{0}))> all(count);
    for (size_t s = 0; s < count; ++s) all[s] = valueOf(s);
    return all;
  };
  const auto takeValid = [&] {
    const auto valid = download<uint32_t>("valid", (count + 31) / 32);
    for (size_t s = 0; s < count; ++s) values.faceActive[s] = hasBit(valid, s) ? 1 : 0;
  };
  if (isNamed(family, "mean_normal")) {
    values.face = make([&](size_t s) { return shared::decodeNormal(faces_[s].normal); });
  } else if (isNamed(family, "albedo")) {
    values.face = make([&](size_t s) { return shared::decodeAlbedo(faces_[s].albedo); });
  } else if (isNamed(family, "area")) {
    values.face = make([&](size_t s) { return faces_[s].area; });
  } else if (isNamed(family, "cluster_id")) {
    values.face = download<int32_t>("labels", count);
  } else if (isNamed(family, "cluster_color")) {
    const auto labels = download<uint32_t>("labels", count);
    values.face = make([&](size_t s) { return shared::colourOfId(labels[s]); });
  } else if (isNamed(family, "cluster_normal")) {
    const auto labels = download<uint32_t>("labels", count);
    const auto clusters = download<shared::ClusterPlace>("cluster_places", buffers_.clusterCount);
    values.face = make([&](size_t s) { return clusters.at(labels[s]).normal; });
  } else if (isNamed(family, "lit")) {
    const auto direct = download<glm::vec3>("face_irradiance", count);
    values.face = make([&](size_t s) { return glm::any(glm::greaterThan(direct[s], glm::vec3(0.f))) ? 1.f : 0.f; });
  } else if (isNamed(family, "direct")) {
    values.face = download<glm::vec3>("face_irradiance", count);
  } else if (isNamed(family, "indirect")) {
    const auto indirect = download<glm::vec4>("irradiance", count);
    values.face = make([&](size_t s) { return glm::vec3(indirect[s]); });
    takeValid();
  } else if (isNamed(family, "error")) {
    values.face = download<glm::vec3>("error", count);
    takeValid();
  } else {
    countRows();
    if (isNamed(family, "visible_clusters")) {
      values.face = rows_->visible;
    } else {
      assert(isNamed(family, "misses"));
      values.face = rows_->misses;
    }
  }
}

/// Chunk by chunk: the rows of a large scene are many times larger than all grids.
void VoxelData::countRows() {
  if (rows_) return;
  const size_t count = faces_.size();
  RowSums sums{std::vector<int32_t>(count), std::vector<int32_t>(voxels_.size()), std::vector<float>(count)};
  constexpr uint64_t kRows = shared::kRowsPerChunk;
  const uint64_t chunkCount = (count + kRows - 1) / kRows;
  const auto rowStart = download<uint32_t>("row_start", chunkCount * (kRows + 1));
  const auto labels = download<uint32_t>("labels", count);
  const std::vector<const gpu::Buffer*> chunks = buffers_.grown("entries");
  assert(chunks.size() == chunkCount);
  const auto clusterCount = static_cast<uint32_t>(buffers_.clusterCount);
  // The last face and voxel that saw a cluster; the faces of a voxel follow each other.
  std::vector<uint32_t> faceSeen(clusterCount, shared::kNone), voxelSeen(clusterCount, shared::kNone);
  for (uint64_t chunk = 0; chunk < chunkCount; ++chunk) {
    const uint64_t firstFace = chunk * kRows, end = std::min<uint64_t>(count, firstFace + kRows);
    const uint32_t* starts = rowStart.data() + chunk * (kRows + 1);
    const auto words = gpu::downloadAs<uint32_t>(*buffers_.device, *chunks[chunk], chunks[chunk]->bytes() / 4);
    for (uint64_t s = firstFace; s < end; ++s) {
      const uint32_t voxel = faces_[s].key >> 3;
      uint32_t rays = 0, misses = 0;
      const auto idCount = static_cast<uint32_t>(clusterCount + count);
      shared::forEachRowEntry(words.data(), starts[s - firstFace], starts[s - firstFace + 1], idCount, [&](uint32_t id, uint32_t hits) {
        rays += hits;
        if (id >= shared::kMissBase) {
          if (id < shared::kAbsorbed) misses += hits;
          return;
        }
        const uint32_t cluster = id < clusterCount ? id : labels.at(id - clusterCount);
        if (faceSeen[cluster] != s) ++sums.visible[s];
        if (voxelSeen[cluster] != voxel) ++sums.voxelVisible[voxel];
        faceSeen[cluster] = static_cast<uint32_t>(s);
        voxelSeen[cluster] = voxel;
      });
      sums.misses[s] = rays > 0 ? static_cast<float>(misses) / static_cast<float>(rays) : 0.f;
    }
  }
  rows_ = std::move(sums);
}

template <class T>
void VoxelData::average(const FamilyValues& values, std::vector<T>& out, std::vector<char>& active) const {
  const auto& face = std::get<std::vector<T>>(values.face);
  for (size_t v = 0; v < voxels_.size(); ++v) {
    T sum{};
    float weight = 0.f;
    for (uint32_t s = first_[v]; s < first_[v + 1]; ++s) {
      if (values.faceActive[s] == 0) continue;
      sum += faces_[s].area * face[s];
      weight += faces_[s].area;
    }
    active[v] = weight > 0.f ? 1 : 0;
    if (weight > 0.f) out[v] = sum / weight;
  }
}

template <class T>
void VoxelData::takeLargest(const FamilyValues& values, std::vector<T>& out, std::vector<char>& active) const {
  const auto& face = std::get<std::vector<T>>(values.face);
  for (size_t v = 0; v < voxels_.size(); ++v) {
    uint32_t largest = shared::kNone;
    for (uint32_t s = first_[v]; s < first_[v + 1]; ++s) {
      if (largest == shared::kNone || faces_[s].area > faces_[largest].area) largest = s;
    }
    active[v] = largest != shared::kNone ? 1 : 0;
    if (largest != shared::kNone) out[v] = face[largest];
  }
}

void VoxelData::summarize(const Family& family, FamilyValues& values) const {
  const size_t count = voxels_.size();
  values.voxelActive.assign(count, 0);
  if (isNamed(family, "area")) {
    std::vector<float> sums(count);
    for (size_t v = 0; v < count; ++v) {
      for (uint32_t s = first_[v]; s < first_[v + 1]; ++s) sums[v] += faces_[s].area;
      values.voxelActive[v] = mask_[v] != 0 ? 1 : 0;
    }
    values.voxel = std::move(sums);
    return;
  }
  if (isNamed(family, "visible_clusters")) {
    for (size_t v = 0; v < count; ++v) values.voxelActive[v] = mask_[v] != 0 ? 1 : 0;
    values.voxel = rows_->voxelVisible;
    return;
  }
  const bool largest = isOfLargestFace(family);
  switch (family.kind) {
    case Kind::Float: {
      std::vector<float> out(count);
      average(values, out, values.voxelActive);
      values.voxel = std::move(out);
      break;
    }
    case Kind::Int: {
      std::vector<int32_t> out(count);
      takeLargest(values, out, values.voxelActive);
      values.voxel = std::move(out);
      break;
    }
    case Kind::Vector: {
      std::vector<glm::vec3> out(count);
      if (largest) {
        takeLargest(values, out, values.voxelActive);
      } else {
        average(values, out, values.voxelActive);
      }
      values.voxel = std::move(out);
      break;
    }
  }
}

}  // namespace radivox::vdb
