#include "modules/vdb/reader.h"

#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>
#include <nanovdb/util/NanoToOpenVDB.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "engine/error.h"

namespace radivox::vdb {

namespace {

[[noreturn]] void fail(const std::string& file, std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  throw Error(ErrorCode::BadInput, "cannot read '" + file + "': " + why + "; is it whole, and a .vdb or .nvdb file?");
}

/// Runs `action`; whatever a library throws names the file.
template <class Action>
auto guarded(const std::string& file, Action&& action) {
  try {
    return action();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(file, "its sizes are beyond this host's memory");
  } catch (const std::exception& e) {
    fail(file, e.what());
  }
}

/// Of the types that are written; the library's own test of a handle for every type it has is two minutes of compiling.
openvdb::GridBase::Ptr toOpenVdb(const nanovdb::GridHandle<>& handle) {
  if (const auto* grid = handle.grid<float>()) return nanovdb::nanoToOpenVDB(*grid);
  if (const auto* grid = handle.grid<int32_t>()) return nanovdb::nanoToOpenVDB(*grid);
  if (const auto* grid = handle.grid<nanovdb::Vec3f>()) return nanovdb::nanoToOpenVDB(*grid);
  const nanovdb::GridMetaData* meta = handle.gridMetaData();
  throw std::runtime_error(std::string(meta != nullptr ? meta->shortGridName() : "a grid") + " holds " +
                           (meta != nullptr ? nanovdb::toStr(meta->gridType()) : "nothing") +
                           ", and of .nvdb files only float, int32 and Vec3f are read: nanovdb_convert makes a .vdb of it");
}

class OpenVdbReader : public Reader {
 public:
  explicit OpenVdbReader(const std::string& path) : path_(path), file_(path) {
    guarded(path_, [&] {
      file_.open(false);  // no delayed loading: what is cut off must be found here, not by a signal
      for (auto name = file_.beginName(); name != file_.endName(); ++name) names_.push_back(name.gridName());
      if (names_.empty()) fail(path_, "it holds no grid");
    });
  }
  const std::vector<std::string>& names() const override { return names_; }
  openvdb::GridBase::Ptr read(size_t i) const override {
    return guarded(path_, [&] { return const_cast<openvdb::io::File&>(file_).readGrid(names_[i]); });
  }
  openvdb::MetaMap metadata() const override { return *file_.getMetadata(); }

 private:
  std::string path_;
  openvdb::io::File file_;
  std::vector<std::string> names_;
};

class NanoVdbReader : public Reader {
 public:
  explicit NanoVdbReader(const std::string& path) : path_(path) {
    guarded(path_, [&] {
      // NanoVDB's own reader takes what is cut off for the end.
      const auto size = static_cast<std::streamoff>(std::filesystem::file_size(path_));
      std::ifstream stream(path_, std::ios::binary);
      std::streamoff at = 0;
      nanovdb::io::Segment segment;
      while (at < size) {
        if (!segment.read(stream) || !stream) fail(path_, "it is cut off");
        at = stream.tellg();
        for (const nanovdb::io::GridMetaData& grid : segment.meta) {
          names_.push_back(grid.gridName);
          at += static_cast<std::streamoff>(grid.fileSize);
        }
        stream.seekg(at);
        segment = {};
      }
      if (at != size || names_.empty()) fail(path_, "it is cut off");
    });
  }
  const std::vector<std::string>& names() const override { return names_; }
  openvdb::GridBase::Ptr read(size_t i) const override {
    return guarded(path_, [&] { return toOpenVdb(nanovdb::io::readGrid(path_, i)); });
  }
  openvdb::MetaMap metadata() const override { return {}; }

 private:
  std::string path_;
  std::vector<std::string> names_;
};

}  // namespace

std::unique_ptr<Reader> Reader::open(const std::string& file) {
  openvdb::initialize();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    throw Error(ErrorCode::BadInput, "cannot read '" + file + "': no such file; check the path");
  }
  std::ifstream stream(file, std::ios::binary);
  char magic[8] = {};
  if (!stream.read(magic, sizeof magic)) fail(file, "it has no header");
  stream.close();
  if (std::memcmp(magic, "NanoVDB", 7) == 0) return std::make_unique<NanoVdbReader>(file);
  if (std::memcmp(magic, " BDV", 4) == 0) return std::make_unique<OpenVdbReader>(file);
  fail(file, "its header is no VDB's");
}

}  // namespace radivox::vdb
