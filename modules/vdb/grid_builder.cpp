#include "modules/vdb/grid_builder.h"

#include <algorithm>
#include <bit>

namespace radivox::vdb {

namespace {

using openvdb::Coord;

template <class T>
struct GridOf;
template <>
struct GridOf<float> {
  using Type = openvdb::FloatGrid;
};
template <>
struct GridOf<int32_t> {
  using Type = openvdb::Int32Grid;
};
template <>
struct GridOf<glm::vec3> {
  using Type = openvdb::Vec3fGrid;
};

float toFile(float value, bool) { return value; }
int32_t toFile(int32_t value, bool) { return value; }
openvdb::Vec3f toFile(const glm::vec3& v, bool turned) { return turned ? openvdb::Vec3f(v.x, -v.z, v.y) : openvdb::Vec3f(v.x, v.y, v.z); }

Coord coordOf(uint32_t packed) {
  const glm::uvec3 voxel = shared::unpackVoxel(packed);
  return Coord(static_cast<int>(voxel.x), static_cast<int>(voxel.y), static_cast<int>(voxel.z));
}

template <class T>
openvdb::GridBase::Ptr fill(const GridName& name, const VoxelData& data, const FamilyValues& values, bool turned) {
  auto grid = GridOf<T>::Type::create();
  auto accessor = grid->getAccessor();
  if (name.face == kWholeVoxel) {
    const auto& all = std::get<std::vector<T>>(values.voxel);
    for (size_t v = 0; v < all.size(); ++v) {
      if (values.voxelActive[v] != 0) accessor.setValue(coordOf(data.voxels()[v]), toFile(all[v], turned));
    }
    return grid;
  }
  const auto& all = std::get<std::vector<T>>(values.face);
  const auto f = static_cast<uint32_t>(name.face);
  for (size_t v = 0; v < data.voxels().size(); ++v) {
    const uint32_t mask = data.mask()[v];
    if (((mask >> f) & 1u) == 0) continue;
    const uint32_t s = data.first()[v] + static_cast<uint32_t>(std::popcount(mask & ((1u << f) - 1u)));
    if (values.faceActive[s] != 0) accessor.setValue(coordOf(data.voxels()[v]), toFile(all[s], turned));
  }
  return grid;
}

void addFacts(openvdb::MetaMap& to, const FileFacts& facts) {
  to.insertMeta("radivox_version", openvdb::StringMetadata(RADIVOX_VERSION));
  to.insertMeta("radivox_scene", openvdb::StringMetadata(facts.scene));
  to.insertMeta("radivox_resolution", openvdb::Int32Metadata(static_cast<int32_t>(facts.resolution)));
  to.insertMeta("radivox_up", openvdb::StringMetadata(facts.up == Up::Y ? "y" : "z"));
}

}  // namespace

FileFacts describeFile(const DumpRequest& request, const shared::Grid& grid) {
  FileFacts facts;
  facts.scene = request.scene;
  facts.resolution = std::max({grid.size.x, grid.size.y, grid.size.z});
  facts.up = request.up;
  const double h = static_cast<double>(grid.h);
  const glm::dvec3 at = request.origin + glm::dvec3(grid.origin) + 0.5 * h;  // the centre of voxel 0
  // OpenVDB multiplies rows: a row is where an index axis goes.
  using openvdb::math::Transform;
  if (request.up == Up::Y) {
    facts.transform = Transform::createLinearTransform(h);
    facts.transform->postTranslate(openvdb::Vec3d(at.x, at.y, at.z));
  } else {
    facts.transform =
        Transform::createLinearTransform(openvdb::Mat4d(h, 0.0, 0.0, 0.0, 0.0, 0.0, h, 0.0, 0.0, -h, 0.0, 0.0, at.x, -at.z, at.y, 1.0));
  }
  return facts;
}

openvdb::MetaMap fileMetadata(const FileFacts& facts) {
  openvdb::MetaMap metadata;
  metadata.insertMeta("creator", openvdb::StringMetadata("radivox " RADIVOX_VERSION));
  metadata.insertMeta("radivox_units", openvdb::StringMetadata("metres; irradiance in W/m^2; area in squares of the voxel edge"));
  addFacts(metadata, facts);
  return metadata;
}

openvdb::GridBase::Ptr buildGrid(const FileFacts& facts, const GridName& name, const VoxelData& data, const FamilyValues& values) {
  const Family& family = *name.family;
  const bool turned = family.isDirection && facts.up == Up::Z;
  openvdb::GridBase::Ptr grid;
  switch (family.kind) {
    case Kind::Float:
      grid = fill<float>(name, data, values, turned);
      break;
    case Kind::Int:
      grid = fill<int32_t>(name, data, values, turned);
      break;
    case Kind::Vector:
      grid = fill<glm::vec3>(name, data, values, turned);
      grid->setVectorType(family.isDirection ? openvdb::VEC_COVARIANT_NORMALIZE : openvdb::VEC_INVARIANT);
      grid->setIsInWorldSpace(true);
      break;
  }
  grid->setName(name.print());
  grid->setTransform(facts.transform->copy());
  grid->setGridClass(family.isFog ? openvdb::GRID_FOG_VOLUME : openvdb::GRID_UNKNOWN);
  grid->setCreator("radivox " RADIVOX_VERSION);
  addFacts(*grid, facts);
  grid->insertMeta("radivox_unit", openvdb::StringMetadata(family.unit));
  grid->insertMeta("radivox_meaning", openvdb::StringMetadata(name.meaning()));
  return grid;
}

uint64_t gridBytes(const VoxelData& data, Kind kind) {
  std::vector<uint32_t> leaves;
  for (const uint32_t packed : data.voxels()) {
    const uint32_t leaf = shared::packVoxel(shared::unpackVoxel(packed) / 8u);
    if (leaves.empty() || leaves.back() != leaf) leaves.push_back(leaf);
  }
  std::sort(leaves.begin(), leaves.end());
  const auto count = static_cast<uint64_t>(std::unique(leaves.begin(), leaves.end()) - leaves.begin());
  const uint64_t item = kind == Kind::Vector ? 12 : 4;
  constexpr uint64_t kLeafVoxels = 512, kLeafRest = 128;
  // An internal node of 128³ voxels has 4096 slots; N is at most 1024, so the one above it holds all.
  const uint64_t internal = (count / 512 + 1) * 4096 * (item + 8) + 32768 * (item + 8);
  return count * (kLeafVoxels * item + kLeafRest) + internal;
}

}  // namespace radivox::vdb
