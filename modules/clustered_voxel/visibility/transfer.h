// clustered_voxel.transfer — form factors between clusters, a sparse matrix.
//
// reads   visibility_row_start, visibility_entries, chunk_table (rows of the faces); weights? (absent: areas); faces, labels, clusters,
//         members
// writes  row_start  u32 × (C + 1)  first entry of each row
//         entries+   u32            column, F_cc' in units of 2⁻ᵇ (shared/transfer_entry.h: b bits are left beside C columns, 24 at most);
//                                   columns ascend within a row; publishes [transfer_entries]
//         sky?       f32 × C        share of the cluster's rays that left the scene; made only if read
// frees   the rows, where nobody reads them later (the last bounce goes to clusters, no sky, no dump): 14 bits an entry and 4 B a face; labels and
//         weights likewise; their makers run again where this does
// runs    when visibility or clusters change; host-paced in two steps, since the number of entries must be known to store them
// cost    four passes over the visibility entries; 4 B an entry
// source  METHODS section 1, Bounce: F_cc' = Σ_{s∈c} w_s m_s,c' / (M Σ w_s), w_s = a_s where no weights are given. Near hits count for their face's cluster.
//
// Sums are integers (weights to 31 bits of the cluster's largest), so any order gives the same bits, and Σ_c' F_cc' + sky = 1
// (less where rays ended on the backs of one-sided surfaces): entries are rounded in running sums, and none is off by a unit. A furnace's rows
// are thus exact, and Sponza's picture at N = 128, with b = 15, is the same to 117 dB as with floats. Faces are taken to have the same number of rays; if not, they weigh by w_s M_s.
#pragma once

#include <memory>

#include "engine/gpu/scan.h"
#include "engine/graph/node.h"

namespace radivox::clustered_voxel {

class Transfer : public graph::Node {
 public:
  static constexpr std::string_view kType = "clustered_voxel.transfer";
  enum class Lanes : uint32_t { Auto, Eight, SixtyFour };
  Transfer();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  uint32_t stepCount(graph::RecordContext&) override { return 2; }
  void record(graph::RecordContext& context) override;
  void stepDone(graph::RecordContext& context) override;

 private:
  Lanes lanes_ = Lanes::Auto;
  params::Table table_;
  std::unique_ptr<gpu::Scan> scan_;
  struct Pipelines {
    gpu::Pipeline count, fill;
  } few_, many_;
  bool hasFew_ = false, hasMany_ = false;
};

}  // namespace radivox::clustered_voxel
