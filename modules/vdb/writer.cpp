#include "modules/vdb/writer.h"

#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <cinttypes>
#include <filesystem>
#include <sstream>

#include "engine/image/atomic_file.h"

namespace radivox::vdb {

namespace {

/// What OpenVDB's own writer does, a grid at a time. The library puts a random tag into the header, which programs compare to see whether a
/// file has changed; a hash of what is written does that and is the same for the same grids.
class OpenVdbWriter : public Writer, private openvdb::io::Archive {
 public:
  OpenVdbWriter(const std::string& path, const FileFacts& facts, size_t gridCount) : file_(path) {
    setCompression((hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) | openvdb::io::COMPRESS_ACTIVE_MASK);
    writeHeader(file_.stream(), true);
    std::ostringstream metadata;
    fileMetadata(facts).writeMeta(metadata);
    put(metadata.str());
    const auto count = static_cast<int32_t>(gridCount);
    put(std::string(reinterpret_cast<const char*>(&count), sizeof count));
  }

  void add(const openvdb::GridBase::Ptr& grid) override {
    openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type(), false);
    writeGrid(descriptor, grid, file_.stream(), true);
    hashGrid(*grid);
  }

  uint64_t finish() override {
    char tag[kTagLength + 1];
    std::snprintf(tag, sizeof tag, "%08" PRIx64 "-%04" PRIx64 "-8%03" PRIx64 "-a%03" PRIx64 "-%012" PRIx64, hash_[0] >> 32,
                  (hash_[0] >> 16) & 0xffff, hash_[0] & 0xfff, hash_[1] >> 52, hash_[1] & ((uint64_t{1} << 48) - 1));
    file_.stream().seekp(kTagOffset);
    file_.stream().write(tag, kTagLength);
    return file_.commit();
  }

 private:
  // Magic number, file version, library version (two words), whether there are offsets; then the tag as text.
  static constexpr std::streamoff kTagOffset = 8 + 4 + 4 + 4 + 1;
  static constexpr std::streamsize kTagLength = 36;

  void hash(const void* bytes, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      const auto byte = static_cast<const unsigned char*>(bytes)[i];
      hash_[0] = (hash_[0] ^ byte) * 0x100000001b3ull;  // FNV-1a
      hash_[1] = (hash_[1] + byte) * 0x9e3779b97f4a7c15ull ^ (hash_[1] >> 29);
    }
  }
  void put(const std::string& bytes) {
    hash(bytes.data(), bytes.size());
    file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  template <class GridType>
  void hashValues(const openvdb::GridBase& base) {
    const auto& grid = static_cast<const GridType&>(base);
    for (auto value = grid.cbeginValueOn(); value; ++value) {
      const openvdb::Coord at = value.getCoord();
      const typename GridType::ValueType v = *value;
      hash(at.data(), 3 * sizeof(int32_t));
      hash(&v, sizeof v);
    }
  }
  void hashGrid(const openvdb::GridBase& grid) {
    std::ostringstream metadata;
    grid.writeMeta(metadata);
    grid.transform().write(metadata);
    const std::string bytes = metadata.str();
    hash(bytes.data(), bytes.size());
    if (grid.isType<openvdb::FloatGrid>()) {
      hashValues<openvdb::FloatGrid>(grid);
    } else if (grid.isType<openvdb::Int32Grid>()) {
      hashValues<openvdb::Int32Grid>(grid);
    } else {
      hashValues<openvdb::Vec3fGrid>(grid);
    }
  }

  image::AtomicFile file_;
  uint64_t hash_[2] = {0xcbf29ce484222325ull, 0x84222325cbf29ce4ull};
};

/// A segment of one grid each.
class NanoVdbWriter : public Writer {
 public:
  explicit NanoVdbWriter(const std::string& path) : file_(path) {}

  void add(const openvdb::GridBase::Ptr& grid) override {
    std::vector<nanovdb::GridHandle<>> handles;
    // One type at a time: the library's own test for every type it has is half a minute of compiling.
    if (const auto floats = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid)) {
      handles.push_back(nanovdb::openToNanoVDB(*floats));
    } else if (const auto integers = openvdb::gridConstPtrCast<openvdb::Int32Grid>(grid)) {
      handles.push_back(nanovdb::openToNanoVDB(*integers));
    } else if (const auto vectors = openvdb::gridConstPtrCast<openvdb::Vec3fGrid>(grid)) {
      handles.push_back(nanovdb::openToNanoVDB(*vectors));
    } else {
      throw Error(ErrorCode::BadInput, "NanoVDB writer: grid '" + grid->getName() + "' holds " + grid->valueType());
    }
    nanovdb::io::writeGrids(file_.stream(), handles, nanovdb::io::Codec::ZIP);
  }
  uint64_t finish() override { return file_.commit(); }

 private:
  image::AtomicFile file_;
};

}  // namespace

bool isNanoVdb(const std::string& file) { return std::filesystem::path(file).extension() == ".nvdb"; }

std::unique_ptr<Writer> Writer::create(const std::string& file, const FileFacts& facts, size_t gridCount) {
  if (isNanoVdb(file)) return std::make_unique<NanoVdbWriter>(file);
  return std::make_unique<OpenVdbWriter>(file, facts, gridCount);
}

}  // namespace radivox::vdb
