// .vdb and .nvdb files, a grid at a time.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <string>
#include <vector>

namespace radivox::vdb {

class Reader {
 public:
  virtual ~Reader() = default;
  virtual const std::vector<std::string>& names() const = 0;  ///< in the order of the file
  virtual openvdb::GridBase::Ptr read(size_t i) const = 0;
  virtual openvdb::MetaMap metadata() const = 0;  ///< of the file

  /// By what the file begins with, whatever its name. Throws BadInput naming the file; so do the others.
  static std::unique_ptr<Reader> open(const std::string& file);
};

}  // namespace radivox::vdb
