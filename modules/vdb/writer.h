// A file that takes one grid after the other, so that only one is in memory.
#pragma once

#include <openvdb/openvdb.h>

#include "modules/vdb/grid_builder.h"

namespace radivox::vdb {

class Writer {
 public:
  virtual ~Writer() = default;
  virtual void add(const openvdb::GridBase::Ptr& grid) = 0;
  virtual uint64_t finish() = 0;  ///< bytes of the file, which is now there

  /// .vdb or .nvdb by the name. Both compressed, and the same bytes for the same grids.
  static std::unique_ptr<Writer> create(const std::string& file, const FileFacts& facts, size_t gridCount);
};

bool isNanoVdb(const std::string& file);

}  // namespace radivox::vdb
