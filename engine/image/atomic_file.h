// A file written in pieces, by somebody who wants a std::ostream: whole under its name or not there at all.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>

namespace radivox::image {

/// Writes to a temporary name beside `path`; commit() flushes and renames. Without it, nothing stays. The stream can seek. Every write that
/// fails throws Error(BadInput) naming `path` and the mend (disk full …) at once, through whatever library writes to the stream.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream();
  /// Bytes of the whole file, once it is there under its name.
  uint64_t commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace radivox::image
