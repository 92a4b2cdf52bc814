// frame.tone_map — radiance to what a screen shows.
//
// reads   color
// writes  display   image RGBA8   sRGB-encoded; pixels that are not numbers are black
//         exposure  f32           factor from radiance to display
//         status    u32 × 4       (host) pixels that are not finite, exposure's bits, 0, 0
// runs    when the radiance or a parameter changes
// cost    auto exposure reads the image twice more; 384 KiB of histograms
// source  METHODS section 5: exposed so that the luminance's 99th percentile is 1, clamped, sRGB-encoded
//
// The percentile is exact and the same bits on every run: two integer histograms over the luminance's float bits (log₂ steps of 1/128
// octave, then the rest) lead to the order statistic of rank 0.99·(n − 1), as image::exposureOf has it. operator=filmic is a rational toe
// and shoulder of our own.
#pragma once

#include "engine/graph/node.h"

namespace radivox::frame {

class ToneMap : public graph::Node {
 public:
  static constexpr std::string_view kType = "frame.tone_map";
  enum class Exposure : uint32_t { Auto, Manual };
  enum class Operator : uint32_t { Linear, Filmic };
  ToneMap();
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override;
  void prepare(graph::PrepareContext& context) override;
  void record(graph::RecordContext& context) override;
  void frameDone(graph::RecordContext& context) override;

 private:
  Exposure exposure_ = Exposure::Auto;
  float ev_ = 0.f;
  Operator operator_ = Operator::Linear;
  params::Table table_;
  gpu::Pipeline histogramHigh_, histogramLow_, selectHigh_, selectLow_, display_;
};

}  // namespace radivox::frame
