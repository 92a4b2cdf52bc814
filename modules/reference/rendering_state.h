// The state of a Rendering. Internal to modules/reference.
#pragma once

#include <tbb/info.h>

#include "modules/reference/accumulator.h"
#include "modules/reference/path_tracer.h"

namespace radivox::reference {

/// Settings::samplesPerPass as it will be. Throws BadInput.
uint32_t choosePassSize(uint32_t asked, uint32_t spp);

/// Slots of a task arena: Embree limits TBB to the processors there are, and asking for more prints a warning.
inline int arenaSize(uint32_t threads) {
  const int most = tbb::info::default_concurrency();
  return threads == 0 || threads > static_cast<uint32_t>(most) ? most : static_cast<int>(threads);
}

struct Rendering::Impl {
  const PathTracer& tracer;
  scene::CameraDescription camera;
  Settings settings;  ///< samplesPerPass as chosen
  bool choosesPassSize = false;
  uint32_t passes = 0;
  double seconds = 0;
  bool reached = false;  ///< the target error
  std::vector<PixelMoments> pixels;
  std::vector<Channels> pass;  ///< the pass under way, so that one given up leaves no trace

  void checkTarget();
  uint32_t passesOf(uint32_t half) const;
  Estimate estimate(size_t aov, uint32_t firstHalf, uint32_t endHalf) const;
  /// π `reflected` / `albedo`; where that is too dark to tell, the plain mean, which counts as 0 where a sample meets nothing. `lights`: 0 direct, 1 indirect.
  Estimate irradiance(size_t lights, const Estimate& reflected, const Estimate& albedo, uint32_t firstHalf, uint32_t endHalf) const;
  Images collect(uint32_t firstHalf, uint32_t endHalf) const;
};

}  // namespace radivox::reference
