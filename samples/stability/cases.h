// The cases that every method is held to, in the order of the table.
#pragma once

#include <vector>

#include "engine/stability/bench.h"

namespace radivox::stability {

using Cases = std::vector<Case>;
void addStiffCases(Cases& cases);
void addLightCases(Cases& cases);
void addGeometryCases(Cases& cases);
void addViewCases(Cases& cases);
void addLeakCases(Cases& cases);

/// What a case renders with unless it says otherwise: coarse, so that the whole suite takes minutes on a CPU.
RenderOptions coarse(uint32_t resolution = 32);
/// The same picture of two scenes: relative RMSE of `aov` where there is surface.
void compareScenes(Bench& bench, Row& row, scene::Scene reference, scene::Scene test, const RenderOptions& options, double tolerance,
                   const std::string& aov = "irradiance_indirect");

/// False, and the row says so, in a build without the path tracer.
bool canTrace(const Bench& bench, Row& row);
/// The path tracer's mean indirect irradiance at `options`' picture, from `spp` samples a pixel; only where canTrace.
double traceMean(Bench& bench, const scene::Scene& scene, RenderOptions options, const char* spp);

/// A picture that must be black; where it is not is noted.
void expectBlack(Bench& bench, Row& row, scene::Scene scene, RenderOptions options, double tolerance = 1e-6);

}  // namespace radivox::stability
