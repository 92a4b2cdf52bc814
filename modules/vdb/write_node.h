// vdb.write — voxels, faces and clusters as grids of an OpenVDB or NanoVDB file: a sink, on the host.
//
// reads   grid, voxels always; and only where a grid of the list needs it: mask, first, faces; fragments, normals; labels, cluster_places;
//         row_start, entries+ of visibility; face_irradiance; irradiance, valid, error of gather (inputs() in catalogue.h: from which node)
// writes  nothing in the graph; the file, whole or not at all
// runs    when an input, the list or the file's name changes: host-paced, a step a grid. Left out where no file is named
// cost    reads each needed buffer once; a grid at a time in host memory (dump.h)
//
// Gathering is lazy: the grids indirect and error hold the faces that this view needs; gather.lazy=off gives them all.
#pragma once

#include <optional>

#include "engine/graph/node.h"
#include "modules/vdb/dump.h"

namespace radivox::vdb {

class Write : public graph::Node {
 public:
  static constexpr std::string_view kType = "vdb.write";
  Write();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override { device_ = &context.device(); }
  uint32_t stepCount(graph::RecordContext& context) override;
  void record(graph::RecordContext&) override {}
  void stepDone(graph::RecordContext& context) override;

  /// Of the last run.
  const DumpSummary& summary() const { return summary_; }

 private:
  void begin(graph::RecordContext& context);

  std::string file_, grids_{kDefaultGrids}, scene_;
  Up up_ = Up::Y;
  params::Table table_;
  gpu::Device* device_ = nullptr;
  std::optional<Dump> dump_;
  DumpSummary summary_;
};

}  // namespace radivox::vdb
