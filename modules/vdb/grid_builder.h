// Values of voxels as OpenVDB grids. For the module's own files: the only ones that include OpenVDB.
#pragma once

#include <openvdb/openvdb.h>

#include "modules/vdb/dump.h"

namespace radivox::vdb {

/// What every grid of a file has in common.
struct FileFacts {
  std::string scene;
  uint32_t resolution = 0;  ///< N
  Up up = Up::Y;
  openvdb::math::Transform::Ptr transform;  ///< index (voxel centres are whole numbers) → world
};

FileFacts describeFile(const DumpRequest& request, const shared::Grid& grid);

/// Of the file.
openvdb::MetaMap fileMetadata(const FileFacts& facts);

/// Voxels in the order of the buffers, so the same values give the same tree.
openvdb::GridBase::Ptr buildGrid(const FileFacts& facts, const GridName& name, const VoxelData& data, const FamilyValues& values);

/// Host bytes of one grid at most.
uint64_t gridBytes(const VoxelData& data, Kind kind);

}  // namespace radivox::vdb
