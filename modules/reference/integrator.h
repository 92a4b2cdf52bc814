// Light arriving at a surface, by one random path. Internal to modules/reference.
#pragma once

#include "modules/reference/sampler.h"
#include "modules/reference/traced_scene.h"

namespace radivox::reference {

struct Irradiance {
  glm::vec3 direct{0.f};    ///< straight from lights, emitters and sky
  glm::vec3 indirect{0.f};  ///< after 1 … bounces reflections
};

/// One unbiased sample of the irradiance at `surface`, W/m².
Irradiance sampleIrradiance(const PathTracer::Impl& scene, const Surface& surface, uint32_t bounces, Sampler& sampler);

}  // namespace radivox::reference
