#include "modules/reference/path_tracer.h"

#include <cmath>
#include <limits>

#include "engine/error.h"
#include "engine/params/params.h"
#include "modules/reference/rendering_state.h"
#include "modules/reference/traced_scene.h"

namespace radivox::reference {

PathTracer::PathTracer(const scene::Scene& scene, Sides sides) : impl_(std::make_unique<Impl>(scene, sides)) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

double PathTracer::buildSeconds() const { return impl_->buildSeconds; }
uint64_t PathTracer::fingerprint() const { return impl_->fingerprint; }

Images PathTracer::render(const scene::CameraDescription& camera, const Settings& settings, const Callbacks& callbacks) const {
  Rendering rendering(*this, camera, settings);
  const double passCount = std::ceil(static_cast<double>(settings.spp) / choosePassSize(settings.samplesPerPass, settings.spp));
  Callbacks whole = callbacks;
  if (callbacks.progress) {
    whole.progress = [&](double fraction) { callbacks.progress((rendering.passes() + fraction) / passCount); };
  }
  while (!rendering.isDone()) {
    if (!rendering.advance(whole)) throw Error(ErrorCode::BadInput, "interrupted");
  }
  return rendering.images();
}

const std::vector<std::string>& Images::names() {
  static const std::vector<std::string> list = {"color", "direct", "indirect", "irradiance_direct", "irradiance_indirect", "albedo"};
  return list;
}

const Estimate& Images::find(std::string_view aov) const {
  const Estimate* const all[] = {&color, &direct, &indirect, &irradianceDirect, &irradianceIndirect, &albedo};
  for (size_t i = 0; i < names().size(); ++i) {
    if (names()[i] == aov) return *all[i];
  }
  std::string list;
  for (const std::string& name : names()) list += (list.empty() ? "" : ", ") + name;
  const std::string near = params::nearestName(std::string(aov), names());
  throw Error(ErrorCode::BadInput, "the reference has no AOV \"" + std::string(aov) + "\"; there are: " + list +
                                       (near.empty() ? "" : ". Did you mean \"" + near + "\"?"));
}

double relativeError(const Estimate& estimate) {
  const double mean = image::meanOf(estimate.mean);
  double sum = 0;
  for (size_t i = 0; i < estimate.mean.data.size(); ++i) {
    const auto r = static_cast<double>(estimate.mean.data[i]);
    const auto variance = static_cast<double>(estimate.variance.data[i]);
    if (variance > 0) sum += variance / (r * r + 0.01 * mean * mean);
  }
  return estimate.mean.data.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(estimate.mean.data.size()));
}

}  // namespace radivox::reference
