// Rows on disk: what was measured once is not measured again.
#pragma once

#include "samples/report/row.h"

namespace radivox::report {

class RowCache {
 public:
  explicit RowCache(std::string folder) : folder_(std::move(folder)) {}
  /// Cost and errors of the row of this key, if its pictures are there too.
  bool find(const std::string& key, const std::string& pictures, Row& row) const;
  void keep(const Row& row) const;

 private:
  std::string folder_;
};

}  // namespace radivox::report
