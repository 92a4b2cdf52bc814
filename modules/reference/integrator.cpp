#include "modules/reference/integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace radivox::reference {

namespace {

constexpr float kPi = 3.14159265358979f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Up to so many punctual lights all are weighed at each surface before one is asked whether it is seen; of more, so many drawn ones.
constexpr size_t kMostWeighedLights = 32;

/// Paths go on for certain while their throughput is above this, and below it with a probability in proportion. Measured on an atrium and
/// in a closed box, 0.02 to 0.2 take the same time for the same error; at 1 the variance of an atrium's indirect light is 2.3 times as large.
constexpr float kRouletteThroughput = 0.1f;

/// How a sample's weight is shared between two ways that could have made it (power heuristic; Veach 1997).
float misWeight(double ownDensity, double otherDensity) {
  const double own = ownDensity * ownDensity;
  return static_cast<float>(own / (own + otherDensity * otherDensity));
}

/// A direction about `n` with density cos θ / π: a square mapped to the disc ring by ring, and raised.
glm::vec3 sampleCosine(const glm::vec3& n, double u, double v) {
  const double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0;
  double radius = 0, angle = 0;
  if (std::abs(x) > std::abs(y)) {
    radius = x;
    angle = 0.25 * M_PI * (y / x);
  } else if (y != 0) {
    radius = y;
    angle = 0.5 * M_PI - 0.25 * M_PI * (x / y);
  }
  const auto a = static_cast<float>(radius * std::cos(angle)), b = static_cast<float>(radius * std::sin(angle));
  const auto c = static_cast<float>(std::sqrt(std::max(0.0, 1.0 - radius * radius)));
  // Any frame about n: its first axis is square to the coordinate axis that n leans to least.
  const glm::vec3 across = std::abs(n.x) < 0.6f ? glm::vec3(0.f, n.z, -n.y) : glm::vec3(-n.z, 0.f, n.x);
  const glm::vec3 tangent = glm::normalize(across);
  return glm::normalize(a * tangent + b * glm::cross(n, tangent) + c * n);
}

/// Irradiance from one punctual light, chosen about in proportion to what it would give unshadowed (resampling; Talbot et al. 2005).
glm::vec3 samplePunctual(const PathTracer::Impl& scene, const Surface& s, const glm::vec3& from, Sampler& sampler) {
  const size_t lightCount = scene.lights.size();
  const bool all = lightCount <= kMostWeighedLights;
  const size_t candidateCount = all ? lightCount : kMostWeighedLights;
  const double u = all ? 0.0 : sampler.next1D();
  double total = 0, drawn = sampler.next1D();
  size_t chosen = 0;
  glm::vec3 chosenIrradiance(0.f);
  double chosenWeight = 0;
  for (size_t k = 0; k < candidateCount; ++k) {
    size_t i = k;
    double share = 1.0;  // expected number of times that this light is a candidate
    if (!all) {
      // Evenly spread draws: one stratum each.
      double offset = u + static_cast<double>(k) * 0.6180339887498949;
      offset -= std::floor(offset);
      const double at = (static_cast<double>(k) + offset) / static_cast<double>(candidateCount);
      i = static_cast<size_t>(std::upper_bound(scene.lightShares.begin(), scene.lightShares.end() - 1, at) - scene.lightShares.begin());
      share = (scene.lightShares[i] - (i > 0 ? scene.lightShares[i - 1] : 0.0)) * static_cast<double>(candidateCount);
    }
    const glm::vec3 irradiance = scene.punctualIrradiance(i, s.position, s.shading);
    const double weight = static_cast<double>(luminance(irradiance)) / share;
    const Punctual& light = scene.lights[i];
    const glm::vec3 toLight = light.type == shared::kLightDirectional ? -light.direction : light.position - s.position;
    if (!(weight > 0) || !(glm::dot(s.geometric, toLight) > 0.f)) continue;
    // A reservoir of one; the random number is stretched over what is left of it.
    total += weight;
    const double keep = weight / total;
    if (drawn < keep) {
      drawn /= keep;
      chosen = i;
      chosenIrradiance = irradiance / static_cast<float>(share);
      chosenWeight = weight;
    } else {
      drawn = (drawn - keep) / (1.0 - keep);
    }
  }
  if (!(total > 0)) return glm::vec3(0.f);
  const Punctual& light = scene.lights[chosen];
  const bool hidden =
      light.type == shared::kLightDirectional ? scene.isBlockedAlong(from, -light.direction) : scene.isBlocked(from, light.position);
  return hidden ? glm::vec3(0.f) : chosenIrradiance * static_cast<float>(total / chosenWeight);
}

/// Irradiance from a point on an emitter, weighted against the chance that the path's own direction finds it.
glm::vec3 sampleEmitter(const PathTracer::Impl& scene, const Surface& s, const glm::vec3& from, Sampler& sampler) {
  const double choice = scene.emitters.size() > 1 ? sampler.next1D() : 0.0;
  const auto [u, v] = sampler.next2D();
  const EmitterPoint y = scene.sampleEmitters(u, v, choice);
  const glm::vec3 to = y.position - s.position;
  const float distance2 = glm::dot(to, to);
  if (!(distance2 > 0.f)) return glm::vec3(0.f);
  const glm::vec3 d = to / std::sqrt(distance2);
  const float cosine = glm::dot(s.shading, d), cosineAtLight = -glm::dot(y.normal, d);
  if (!(cosine > 0.f) || !(cosineAtLight > 0.f) || !(glm::dot(s.geometric, d) > 0.f)) return glm::vec3(0.f);
  if (y.emission == glm::vec3(0.f) || scene.isBlocked(from, y.position + y.normal * y.clearance)) return glm::vec3(0.f);
  const double density = y.areaDensity * static_cast<double>(distance2) / static_cast<double>(cosineAtLight);  // per sr
  // With gltf sides a surface may hide the emitter from here and not the other way; the shadow's word counts, as in the renderer.
  const float weight = scene.obeysSides ? 1.f : misWeight(density, static_cast<double>(cosine / kPi));
  return y.emission * static_cast<float>(static_cast<double>(cosine * weight) / density);
}

/// Irradiance from a point of the sky's image, likewise.
glm::vec3 sampleSky(const PathTracer::Impl& scene, const Surface& s, const glm::vec3& from, Sampler& sampler) {
  const auto [u, v] = sampler.next2D();
  const SkySample sky = scene.skyDistribution.sample(*scene.skyImage, u, v);
  const float cosine = glm::dot(s.shading, sky.direction);
  if (!(sky.density > 0) || !(cosine > 0.f) || !(glm::dot(s.geometric, sky.direction) > 0.f)) return glm::vec3(0.f);
  // Where surfaces have one side, what a path sees counts, so that both ways see the same.
  Surface ignored;
  if (scene.obeysSides ? scene.findSurface(from, sky.direction, 0.f, kInfinity, ignored) : scene.isBlockedAlong(from, sky.direction))
    return glm::vec3(0.f);
  const float weight = misWeight(sky.density, static_cast<double>(cosine / kPi));
  return sky.radiance * static_cast<float>(static_cast<double>(cosine * weight) / sky.density);
}

/// Radiance of the sky as the path's own direction finds it.
glm::vec3 foundSky(const PathTracer::Impl& scene, const glm::vec3& d, float cosine) {
  if (!scene.skyImage) return scene.sky;
  const glm::vec3 image = scene.skyImage->radiance(d);
  return scene.sky + misWeight(static_cast<double>(cosine / kPi), scene.skyDistribution.density(image)) * image;
}

glm::vec3 sampleLights(const PathTracer::Impl& scene, const Surface& s, const glm::vec3& from, Sampler& sampler) {
  glm::vec3 irradiance(0.f);
  if (!scene.lights.empty()) irradiance += samplePunctual(scene, s, from, sampler);
  if (scene.hasEmitters()) irradiance += sampleEmitter(scene, s, from, sampler);
  if (scene.skyImage) irradiance += sampleSky(scene, s, from, sampler);
  return irradiance;
}

}  // namespace

Irradiance sampleIrradiance(const PathTracer::Impl& scene, const Surface& surface, uint32_t bounces, Sampler& sampler) {
  Irradiance result;
  Surface s = surface;
  glm::vec3 from = s.position + s.geometric * s.clearance;
  result.direct = sampleLights(scene, s, from, sampler);
  // Emitters and sky are also found by the path's own directions, which therefore go one step further than the last reflection.
  const bool lightIsFound =
      (scene.hasEmitters() && !scene.obeysSides) || scene.sky != glm::vec3(0.f) || scene.skyImage || scene.hasUnsampledEmitters;
  glm::vec3 throughput(1.f);  // of reflected light so far
  for (uint32_t depth = 0; depth < bounces || lightIsFound; ++depth) {
    const auto [u, v] = sampler.next2D();
    const glm::vec3 d = sampleCosine(s.shading, u, v);
    const float cosine = glm::dot(s.shading, d);
    if (!(glm::dot(s.geometric, d) > 0.f) || !(cosine > 0.f)) break;
    glm::vec3& arriving = depth == 0 ? result.direct : result.indirect;
    Surface hit;
    if (!scene.findSurface(from, d, 0.f, kInfinity, hit)) {
      arriving += kPi * throughput * foundSky(scene, d, cosine);
      break;
    }
    const double areaDensity = scene.emitterDensity(hit.triangle);
    if (hit.emission != glm::vec3(0.f) && !(scene.obeysSides && areaDensity > 0)) {
      const glm::vec3 to = hit.position - s.position;
      const double density = areaDensity * static_cast<double>(glm::dot(to, to)) / static_cast<double>(-glm::dot(hit.geometric, d));
      arriving += kPi * misWeight(static_cast<double>(cosine / kPi), density) * throughput * hit.emission;
    }
    if (depth == bounces) break;

    throughput *= hit.albedo;
    const float brightest = std::max(throughput.x, std::max(throughput.y, throughput.z));
    if (!(brightest > 0.f)) break;
    if (brightest < kRouletteThroughput) {
      const float survival = brightest / kRouletteThroughput;
      if (sampler.next1D() >= static_cast<double>(survival)) break;
      throughput /= survival;
    }
    s = hit;
    from = s.position + s.geometric * s.clearance;
    result.indirect += throughput * sampleLights(scene, s, from, sampler);
  }
  return result;
}

}  // namespace radivox::reference
