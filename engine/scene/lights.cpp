// Lights and shadow views of a scene, within a budget.
#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "engine/scene/light_setup.h"
#include "engine/scene/sky.h"

namespace radivox::scene {

namespace {

constexpr uint64_t kBytesPerTexel = 8;      // depth and triangle
constexpr uint32_t kMinResolution = 64;     // below it a shadow map says nothing
constexpr uint32_t kMinEmitterSamples = 8;  // fewer show as separate shadows

shared::Light toLight(const PunctualLight& from) {
  shared::Light light{};
  light.position = from.position;
  light.type = from.type;
  light.direction = glm::normalize(from.direction);
  light.range = from.range;
  light.intensity = from.intensity;
  light.cosInner = std::cos(from.innerConeAngle);
  light.cosOuter = std::cos(from.outerConeAngle);
  light.triangle = shared::kNoTexture;
  return light;
}

/// Resolutions and samples as they shrink to fit.
struct Plan {
  ViewResolutions resolutions;
  uint32_t emitterSamples;
};

std::vector<shared::Light> listLights(const Scene& scene, const std::vector<shared::EmissiveTriangle>& emitters, uint32_t emitterSamples) {
  std::vector<shared::Light> lights;
  for (const PunctualLight& light : scene.lights) {
    if (light.intensity != glm::vec3(0.f)) lights.push_back(toLight(light));
  }
  if (scene.sky) {
    for (const PunctualLight& sun : scene.sky->suns) {
      lights.push_back(toLight(sun));
      lights.back().triangle = shared::kSkySun;
    }
  }
  const auto samples = sampleEmitters(scene, emitters, emitterSamples);
  lights.insert(lights.end(), samples.begin(), samples.end());
  return lights;
}

/// Tiles without projections: enough to pack.
std::vector<shared::ShadowView> sketchViews(const std::vector<shared::Light>& lights, const ViewResolutions& resolutions) {
  std::vector<shared::ShadowView> views;
  for (const shared::Light& light : lights) {
    for (uint32_t i = 0; i < viewCountOf(light); ++i) {
      views.emplace_back();
      views.back().resolution = viewResolutionOf(light, resolutions, i);
    }
  }
  return views;
}

bool fits(const std::vector<shared::Light>& lights, const ViewResolutions& resolutions, const LightOptions& options) {
  auto views = sketchViews(lights, resolutions);
  if (views.empty()) return true;
  const uint64_t side = chooseLayerSide(views, options.maxShadowSide);
  if (side > options.maxShadowSide) return false;
  const uint64_t layers = packTiles(views, static_cast<uint32_t>(side));
  return layers <= options.maxShadowLayers && side * side * layers * kBytesPerTexel <= options.maxShadowBytes;
}

/// Halves the resolution whose views take most texels. False when all are at their least.
bool halveLargestClass(const std::vector<shared::Light>& lights, ViewResolutions& resolutions) {
  uint64_t texels[4] = {0, 0, 0, 0};
  for (const shared::Light& light : lights) {
    for (uint32_t i = 0; i < viewCountOf(light); ++i) {
      const uint64_t r = viewResolutionOf(light, resolutions, i);
      const bool wideSpot = light.type == shared::kLightSpot && viewCountOf(light) > 1;
      texels[light.type == shared::kLightDirectional         ? 0
             : light.type == shared::kLightEmitterSample     ? 3
             : light.type == shared::kLightPoint || wideSpot ? 2
                                                             : 1] += r * r;
    }
  }
  uint32_t* values[4] = {&resolutions.directional, &resolutions.spot, &resolutions.point, &resolutions.emitter};
  int largest = -1;
  for (int k = 0; k < 4; ++k) {
    if (texels[k] == 0 || *values[k] / 2 < kMinResolution) continue;
    if (largest < 0 || texels[k] > texels[largest]) largest = k;
  }
  if (largest < 0) return false;
  *values[largest] /= 2;
  return true;
}

[[noreturn]] void refuse(const Scene& scene, const std::vector<shared::Light>& lights, const ViewResolutions& resolutions,
                         const LightOptions& options) {
  // The most lights, taken in order, that fit at the least resolution.
  size_t lo = 0, hi = lights.size();
  while (lo + 1 < hi) {
    const size_t middle = (lo + hi) / 2;
    const std::vector<shared::Light> some(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(middle));
    (fits(some, resolutions, options) ? lo : hi) = middle;
  }
  throw Error(ErrorCode::OutOfMemory, scene.name + ": shadow maps of " + std::to_string(lights.size()) + " lights do not fit into " +
                                          std::to_string(options.maxShadowBytes >> 20) + " MiB and " +
                                          std::to_string(options.maxShadowLayers) + " layers even at " + std::to_string(kMinResolution) +
                                          " texels a side; " + std::to_string(lo) + " of them fit: remove lights or raise the limit");
}

Traits traitsOfScene(const Scene& scene, const LightOptions& options) {
  Traits traits = scene.traits();
  if (traits.emissiveTriangleCount > 0 && options.emitterSamples == 0) traits.emittersByRays = true;
  traits.kept = options.kept;
  return traits;
}

/// Views that no face is in get no texels, but stay in the list: a point that lies in one finds it, and nothing there.
void leaveOutDarkViews(const Scene& scene, const Traits& traits, const LightOptions& options, LightSetup& setup) {
  setup.wholeShadowSide = setup.shadowResolution;
  setup.wholeShadowLayers = setup.shadowLayers;
  if (!options.fixed || setup.views.empty()) return;
  const std::vector<bool> dark = findDarkViews(scene, traits, setup.lights, setup.views);
  setup.darkViewCount = static_cast<uint32_t>(std::count(dark.begin(), dark.end(), true));
  if (setup.darkViewCount == 0 || traits.keeps(Feature::DarkViews)) return;
  for (size_t i = 0; i < setup.views.size(); ++i) {
    if (dark[i]) setup.views[i].resolution = 0;
  }
  setup.shadowResolution = chooseLayerSide(setup.views, options.maxShadowSide);
  setup.shadowLayers = packTiles(setup.views, setup.shadowResolution);
}

}  // namespace

LightSetup setUpLights(const Scene& scene, const LightOptions& options) {
  LightSetup setup;
  const Traits traits = traitsOfScene(scene, options);
  setup.emissive = listEmitters(scene);
  const auto atLeast = [&](uint32_t resolution) { return std::clamp(resolution, 2u, std::max(2u, options.maxShadowSide)); };
  Plan plan{{atLeast(options.shadowResolution), atLeast(options.shadowResolution), atLeast(options.pointShadowResolution),
             atLeast(options.emitterShadowResolution)},
            traits.emittersByRays ? 0 : options.emitterSamples};
  const Plan wanted = plan;
  setup.lights = listLights(scene, setup.emissive, plan.emitterSamples);
  if (traits.triangleCount > 0) {
    while (!fits(setup.lights, plan.resolutions, options)) {
      if (halveLargestClass(setup.lights, plan.resolutions)) continue;
      if (plan.emitterSamples / 2 < kMinEmitterSamples || setup.emissive.empty()) refuse(scene, setup.lights, plan.resolutions, options);
      plan.emitterSamples /= 2;
      setup.lights = listLights(scene, setup.emissive, plan.emitterSamples);
    }
  }
  const auto note = [&](const char* what, uint32_t from, uint32_t to) {
    if (from != to)
      setup.notes.push_back(std::string(what) + " lowered from " + std::to_string(from) + " to " + std::to_string(to) +
                            " so that all shadow maps fit");
  };
  note("shadow resolution of directional lights", wanted.resolutions.directional, plan.resolutions.directional);
  note("shadow resolution of spot lights", wanted.resolutions.spot, plan.resolutions.spot);
  note("shadow resolution of point lights", wanted.resolutions.point, plan.resolutions.point);
  note("shadow resolution of emitter samples", wanted.resolutions.emitter, plan.resolutions.emitter);
  note("emitter samples", wanted.emitterSamples, plan.emitterSamples);

  for (size_t i = 0; i < setup.lights.size(); ++i) {
    shared::Light& light = setup.lights[i];
    if (light.type == shared::kLightEmitterSample) ++setup.emitterSampleCount;
    // Nothing casts a shadow in an empty scene.
    if (traits.triangleCount > 0) appendViews(scene, traits, plan.resolutions, static_cast<uint32_t>(i), light, setup.views);
  }
  if (!setup.views.empty()) {
    setup.shadowResolution = chooseLayerSide(setup.views, options.maxShadowSide);
    setup.shadowLayers = packTiles(setup.views, setup.shadowResolution);
  }
  leaveOutDarkViews(scene, traits, options, setup);
  return setup;
}

Traits traitsFor(const Scene& scene, const LightOptions& options) {
  Traits traits = traitsOfScene(scene, options);
  if (!options.fixed) return traits;
  for (const PunctualLight& light : scene.lights) {
    if (light.intensity == glm::vec3(0.f) || endsBefore(traits, toLight(light))) ++traits.unreachingLightCount;
  }
  const LightSetup setup = setUpLights(scene, options);
  traits.shadowViewCount = static_cast<uint32_t>(setup.views.size());
  traits.darkViewCount = setup.darkViewCount;
  traits.wholeShadowSide = setup.wholeShadowSide;
  traits.wholeShadowLayers = setup.wholeShadowLayers;
  return traits;
}

}  // namespace radivox::scene
