#include "modules/vdb/dump.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "engine/image/image.h"
#include "modules/vdb/grid_builder.h"
#include "modules/vdb/wiring.h"
#include "modules/vdb/writer.h"

namespace radivox::vdb {

namespace {

/// What the host can still give, from the kernel; 0: unknown.
uint64_t availableMemory() {
  std::ifstream file("/proc/meminfo");
  std::string word;
  uint64_t kibibytes = 0;
  while (file >> word) {
    if (word == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

std::string printMiB(uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MiB"; }

/// The node that makes an input, for messages.
std::string sourceOf(const char* port) {
  const auto found = std::find_if(inputs().begin(), inputs().end(), [&](const Input& i) { return std::string_view(i.port) == port; });
  return std::string(found->nodeType) + "." + found->from;
}

}  // namespace

void checkFileName(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  if (extension != ".vdb" && extension != ".nvdb") {
    throw Error(ErrorCode::BadInput, "'" + file + "': unknown kind of file; end the name in .vdb or .nvdb");
  }
  image::checkWritable(file);
}

struct Dump::Impl {
  Impl(DumpRequest asked, Buffers buffers) : request(std::move(asked)), grids(parseGrids(request.grids)) {
    checkFileName(request.file);
    openvdb::initialize();
    // Faces are read where a grid that can be made needs them.
    const auto find = buffers.find;
    const bool haveFaces = find("mask") != nullptr && find("first") != nullptr && find("faces") != nullptr;
    data.emplace(std::move(buffers), haveFaces && (needsOf(grids) & NeedFaces) != 0);
    leaveOutMissing();
    checkMemory();
    facts = describeFile(request, data->grid());
    writer = Writer::create(request.file, facts, grids.size());
    summary.resolution = facts.resolution;
    summary.voxelEdge = data->grid().h;
    summary.voxelCount = data->voxels().size();
  }

  void leaveOutMissing() {
    std::vector<GridName> kept;
    for (const GridName& grid : grids) {
      const char* missing = data->findMissing(grid.needs());
      if (missing == nullptr) {
        kept.push_back(grid);
        continue;
      }
      const std::string why = grid.print() + ": needs " + sourceOf(missing) + ", which this graph does not make here";
      if (grid.named) throw Error(ErrorCode::BadInput, "grid " + why + "; leave the grid out, or use a graph that has the node");
      summary.leftOut.push_back(why);
    }
    grids = std::move(kept);
    if (grids.empty()) throw Error(ErrorCode::BadInput, "none of the grids '" + request.grids + "' can be made; see --grids help");
  }

  void checkMemory() {
    uint64_t most = 0;
    for (const GridName& grid : grids) {
      // A .nvdb grid is made beside the grid it is made from.
      const uint64_t copies = isNanoVdb(request.file) ? 3 : 1;
      most = std::max(most, data->bytesToRead(*grid.family) + copies * gridBytes(*data, grid.family->kind));
    }
    const uint64_t rows = (needsOf(grids) & NeedRows) != 0 ? 16 * data->faces().size() : 0;
    summary.memoryBytes = data->bytes() + rows + most;
    const uint64_t available = availableMemory();
    if (available == 0 || rows + most < available) return;
    throw Error(ErrorCode::OutOfMemory, "'" + request.file + "': its grids need " + printMiB(rows + most) +
                                            " of host memory one by one, and " + printMiB(available) +
                                            " are free; choose a lower voxelize.resolution, or grids of numbers");
  }

  void readFamily(size_t i) {
    const Family* family = grids[i].family;
    if (family == current) return;
    values = {};
    bool voxel = false, face = false;
    for (const GridName& grid : grids) {
      if (grid.family != family) continue;
      (grid.face == kWholeVoxel ? voxel : face) = true;
    }
    values = data->read(*family, voxel, face);
    current = family;
  }

  DumpRequest request;
  std::vector<GridName> grids;
  std::optional<VoxelData> data;
  FileFacts facts;
  std::unique_ptr<Writer> writer;
  const Family* current = nullptr;
  FamilyValues values;
  DumpSummary summary;
};

Dump::Dump(DumpRequest request, Buffers buffers) : impl_(std::make_unique<Impl>(std::move(request), std::move(buffers))) {}
Dump::~Dump() = default;
Dump::Dump(Dump&&) noexcept = default;

size_t Dump::gridCount() const { return impl_->grids.size(); }
size_t Dump::gridsDone() const { return impl_->summary.grids.size(); }

void Dump::writeNext() {
  const size_t i = gridsDone();
  impl_->readFamily(i);
  const openvdb::GridBase::Ptr grid = buildGrid(impl_->facts, impl_->grids[i], *impl_->data, impl_->values);
  impl_->writer->add(grid);
  impl_->summary.grids.push_back({impl_->grids[i].print(), grid->activeVoxelCount()});
}

DumpSummary Dump::finish() {
  impl_->summary.fileBytes = impl_->writer->finish();
  return impl_->summary;
}

DumpSummary dumpFrame(gpu::Device& device, const graph::Graph& graph, const graph::Executor& executor, const scene::Traits& traits,
                      DumpRequest request, const graph::Progress& progress) {
  const auto endpoint = [&graph](const char* port) {
    for (const Input& input : inputs()) {
      if (std::string_view(input.port) == port) return findSource(graph, input);
    }
    return std::string();
  };
  const auto count = [&executor](const char* name) {
    const auto found = executor.counts().find(name);
    return found == executor.counts().end() ? 0 : found->second;
  };
  Buffers buffers{&device,
                  [&](const char* port) -> const gpu::Buffer* {
                    const std::string name = endpoint(port);
                    return name.empty() ? nullptr : executor.findBuffer(name);
                  },
                  [&](const char* port) { return executor.findGrown(endpoint(port)); },
                  count("voxels"),
                  count("faces"),
                  count("clusters")};
  if (buffers.find("grid") == nullptr || buffers.find("voxels") == nullptr) {
    throw Error(ErrorCode::BadInput, "'" + request.file + "': this graph makes no voxels; use graph clustered_voxel");
  }
  request.origin = traits.origin;
  Dump dump(std::move(request), std::move(buffers));
  while (dump.gridsDone() < dump.gridCount()) {
    if (progress) progress("vdb", static_cast<double>(dump.gridsDone()) / static_cast<double>(dump.gridCount()));
    dump.writeNext();
  }
  return dump.finish();
}

}  // namespace radivox::vdb
