#include "modules/vdb/write_node.h"

#include <filesystem>

namespace radivox::vdb {

using params::Invalidates;

namespace {

void checkExtension(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  if (file.empty() || extension == ".vdb" || extension == ".nvdb") return;
  throw Error(ErrorCode::BadInput, "unknown kind of file; end the name in .vdb or .nvdb");
}

}  // namespace

Write::Write()
    : table_({params::text("file", &file_, "the .vdb or .nvdb file to write; empty: none", Invalidates::Plan, checkExtension),
              params::text("grids", &grids_, "names with commas between them; `radivox vdb --grids help` lists them", Invalidates::Plan,
                           [](const std::string& grids) { parseGrids(grids); }),
              params::text("scene", &scene_, "the scene's name, for the file's metadata", Invalidates::Rerun),
              params::choice("up", &up_, {"y", "z"}, "y: axes as in the scene; z: turned as Blender turns glTF", Invalidates::Rerun)}) {}

void Write::declare(graph::Declaration& d) {
  if (file_.empty()) d.leaveOut("no file is named (param file)");
  const uint32_t needs = needsOf(parseGrids(grids_));
  for (const Input& input : inputs()) {
    graph::Port& port = d.read(input.port, std::string(input.nodeType) + "." + input.from, graph::UseTransfer);
    port.optional = input.need != 0;
    port.unwanted = input.need != 0 && (input.need & needs) == 0;
    port.unwantedReason = "no grid of the list needs it";
  }
  d.hostPaced();
}

// Step 0 reads the voxels; then a step a grid, and one that finishes.
uint32_t Write::stepCount(graph::RecordContext& context) {
  return dump_ ? static_cast<uint32_t>(dump_->gridCount()) + 2 : context.step() + 1;
}

void Write::stepDone(graph::RecordContext& context) {
  if (context.step() == 0) return begin(context);
  if (dump_->gridsDone() < dump_->gridCount()) {
    dump_->writeNext();
    context.reportProgress(static_cast<double>(dump_->gridsDone()) / static_cast<double>(dump_->gridCount()));
    return;
  }
  summary_ = dump_->finish();
  dump_.reset();
  context.reportStat("grids", static_cast<double>(summary_.grids.size()));
  context.reportStat("file_bytes", static_cast<double>(summary_.fileBytes));
  context.reportStat("memory_bytes", static_cast<double>(summary_.memoryBytes));
}

void Write::begin(graph::RecordContext& context) {
  dump_.reset();
  const auto count = [&context](const char* name, const char* port) -> uint64_t { return context.has(port) ? context.count(name) : 0; };
  Buffers buffers{device_,
                  [&context](const char* port) -> const gpu::Buffer* { return context.has(port) ? &context.buffer(port) : nullptr; },
                  [&context](const char* port) { return context.grown(port); },
                  count("voxels", "voxels"),
                  count("faces", "faces"),
                  count("clusters", "labels")};
  DumpRequest request{file_, grids_, scene_, up_, context.traits().origin};
  dump_.emplace(std::move(request), std::move(buffers));
}

}  // namespace radivox::vdb
