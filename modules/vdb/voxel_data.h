// From the GPU's buffers to values of voxels and faces in host memory. No OpenVDB.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/gpu/resources.h"
#include "modules/vdb/catalogue.h"
#include "shaders/shared/voxel_codec.h"

namespace radivox::vdb {

/// Where the buffers are. The GPU must be done with them.
struct Buffers {
  gpu::Device* device = nullptr;
  std::function<const gpu::Buffer*(const char* port)> find;                ///< null: not there
  std::function<std::vector<const gpu::Buffer*>(const char* port)> grown;  ///< of `entries`
  uint64_t voxelCount = 0, faceCount = 0, clusterCount = 0;                ///< 0 where nobody has counted
};

using Values = std::variant<std::vector<float>, std::vector<int32_t>, std::vector<glm::vec3>>;

/// What a family holds. A voxel or face that is not active is no voxel of the grid.
struct FamilyValues {
  Values voxel;                   ///< V
  Values face;                    ///< F; empty where the family has none
  std::vector<char> voxelActive;  ///< V
  std::vector<char> faceActive;   ///< F
};

class VoxelData {
 public:
  /// Reads what most grids need; with `faces` the faces too.
  VoxelData(Buffers buffers, bool faces);

  const shared::Grid& grid() const { return grid_; }
  const std::vector<uint32_t>& voxels() const { return voxels_; }
  const std::vector<uint32_t>& mask() const { return mask_; }
  const std::vector<uint32_t>& first() const { return first_; }
  const std::vector<shared::Face>& faces() const { return faces_; }

  /// The first input of `needs` that is not there; null: all are.
  const char* findMissing(uint32_t needs) const;
  /// `voxel` and `face` say which of the two are wanted; the voxels of most families are means over faces.
  FamilyValues read(const Family& family, bool voxel, bool face);

  /// Host bytes of the above: now, and while the family is read.
  uint64_t bytes() const;
  uint64_t bytesToRead(const Family& family) const;

 private:
  struct RowSums {
    std::vector<int32_t> visible, voxelVisible;  ///< distinct clusters
    std::vector<float> misses;                   ///< share of rays
  };
  template <class T>
  std::vector<T> download(const char* port, uint64_t count) const;
  void countRows();
  void readVoxelFamily(const Family& family, FamilyValues& values);
  void readFaceFamily(const Family& family, FamilyValues& values);
  void summarize(const Family& family, FamilyValues& values) const;
  template <class T>
  void average(const FamilyValues& values, std::vector<T>& out, std::vector<char>& active) const;
  template <class T>
  void takeLargest(const FamilyValues& values, std::vector<T>& out, std::vector<char>& active) const;

  Buffers buffers_;
  shared::Grid grid_{};
  std::vector<uint32_t> voxels_, mask_, first_;
  std::vector<shared::Face> faces_;
  std::optional<RowSums> rows_;
};

}  // namespace radivox::vdb
