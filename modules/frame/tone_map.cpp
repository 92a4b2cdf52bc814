#include "modules/frame/tone_map.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace radivox::frame {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {
constexpr uint32_t kBinCount = 32768 + 65536;  // kHighBins + kLowBins of tone_map.glsl
constexpr uint32_t kSelectionWords = 5;
}  // namespace

ToneMap::ToneMap()
    : table_({params::choice("exposure", &exposure_, {"auto", "manual"},
                             "auto: the luminance's 99th percentile becomes 1; manual: ev alone", params::Invalidates::Plan),
              params::number("ev", &ev_, {-64, 64}, "exposure (manual) or compensation (auto) in stops: factor 2^ev",
                             params::Invalidates::Rerun),
              params::choice("operator", &operator_, {"linear", "filmic"}, "linear: clamped at 1; filmic: a toe and a shoulder",
                             params::Invalidates::Plan)}) {}

void ToneMap::declare(graph::Declaration& d) {
  d.read("color", "radiance, W/(m² sr)");
  d.write("display", Shape::image(VK_FORMAT_R8G8B8A8_UNORM, Extent::of("width"), Extent::of("height")), "sRGB-encoded");
  d.write("exposure", Shape::buffer(4, 1), "f32: factor from radiance to display");
  d.readBack("status", Shape::buffer(4, 4), "pixels that are not finite; exposure's bits; 0; 0");
  if (exposure_ == Exposure::Auto) {
    d.scratch("bins", Shape::buffer(4, kBinCount), "histograms of the luminance's bits, high and low half");
    d.scratch("selection", Shape::buffer(4, kSelectionWords), "where the percentile is");
  }
}

void ToneMap::prepare(graph::PrepareContext& context) {
  constexpr auto kB = BindingType::StorageBuffer;
  constexpr auto kI = BindingType::StorageImage;
  gpu::Device& device = context.device();
  if (exposure_ == Exposure::Auto) {
    const auto histogram = [&](uint32_t low) {
      return gpu::Pipeline(
          device, gpu::ComputePipelineInfo{.shader = "frame/tone_map_histogram.comp", .bindings = {kI, kB, kB}, .constants = {{0, low}}});
    };
    const auto select = [&](uint32_t low) {
      return gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "frame/tone_map_select.comp",
                                                            .bindings = {kB, kB, kB},
                                                            .pushConstantBytes = sizeof(float),
                                                            .constants = {{0, low}}});
    };
    histogramHigh_ = histogram(0);
    histogramLow_ = histogram(1);
    selectHigh_ = select(0);
    selectLow_ = select(1);
  }
  display_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{
                  .shader = "frame/tone_map.comp", .bindings = {kI, kB, kI, kB}, .constants = {{0, static_cast<uint32_t>(operator_)}}});
}

void ToneMap::record(graph::RecordContext& context) {
  gpu::Commands& commands = context.commands();
  const gpu::Image& color = context.image("color");
  const gpu::Image& display = context.image("display");
  const gpu::Buffer& exposure = context.buffer("exposure");
  const gpu::Buffer& status = context.buffer("status");
  const uint32_t groupsX = (color.info().width + 7) / 8;
  const uint32_t groupsY = (color.info().height + 7) / 8;
  const float compensation = std::exp2(ev_);

  commands.fill(status, 0);
  if (exposure_ == Exposure::Manual) {
    commands.fill(exposure, std::bit_cast<uint32_t>(compensation));
    commands.barrier();
  } else {
    const gpu::Buffer& bins = context.buffer("bins");
    const gpu::Buffer& selection = context.buffer("selection");
    commands.fill(bins, 0);
    for (const bool low : {false, true}) {
      commands.barrier();
      commands.bind(low ? histogramLow_ : histogramHigh_, {color, bins, selection});
      commands.dispatch(groupsX, groupsY);
      commands.barrier();
      commands.bind(low ? selectLow_ : selectHigh_, {bins, selection, exposure});
      commands.push(compensation);
      commands.dispatch(1);
    }
    commands.barrier();
  }
  commands.bind(display_, {color, exposure, display, status});
  commands.dispatch(groupsX, groupsY);
}

void ToneMap::frameDone(graph::RecordContext& context) {
  uint32_t words[2];
  std::memcpy(words, context.buffer("status").mapped(), sizeof words);
  context.reportStat("not_finite_pixels", words[0]);
  context.reportStat("exposure", static_cast<double>(std::bit_cast<float>(words[1])));
}

}  // namespace radivox::frame
