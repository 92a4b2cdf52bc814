// Emissive triangles, and points on them that stand for them as lights.
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/geometry.h"
#include "engine/scene/light_setup.h"
#include "engine/scene/texture.h"

namespace radivox::scene {

namespace {

double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// Samples stand this share of the diagonal above their surface, clear of its rounding.
constexpr double kLift = 1e-5;

/// Point i of the R2 low-discrepancy sequence (additive recurrence by powers of the plastic number's inverse).
glm::dvec2 r2Point(uint32_t i) {
  constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;
  const double u = 0.5 + kA * (i + 1.0), v = 0.5 + kB * (i + 1.0);
  return {u - std::floor(u), v - std::floor(v)};
}

}  // namespace

std::vector<shared::EmissiveTriangle> listEmitters(const Scene& scene) {
  std::vector<shared::EmissiveTriangle> out;
  std::vector<double> cumulative;
  double total = 0;
  for (size_t t = 0; t < scene.triangleCount(); ++t) {
    if ((scene.materials[scene.triangleMaterials[t]].flags & shared::kMaterialEmissive) == 0u) continue;
    shared::EmissiveTriangle emitter{};
    emitter.triangle = static_cast<uint32_t>(t);
    const double area = glm::length(areaVector(scene, t)) * 0.5;
    emitter.area = static_cast<float>(area);
    emitter.emission = meanEmission(scene, t);
    // Triangles that their texture leaves dark stay in the list, with no power: counts then agree with the traits.
    total += area * luminance(emitter.emission);
    cumulative.push_back(total);
    out.push_back(emitter);
  }
  for (size_t i = 0; i < out.size(); ++i) out[i].cumulativePower = total > 0 ? static_cast<float>(cumulative[i] / total) : 0.f;
  if (!out.empty() && total > 0) out.back().cumulativePower = 1.f;
  return out;
}

std::vector<shared::Light> sampleEmitters(const Scene& scene, const std::vector<shared::EmissiveTriangle>& emitters, uint32_t count) {
  std::vector<double> cumulative;
  double total = 0;
  for (const auto& emitter : emitters) {
    total += static_cast<double>(emitter.area) * luminance(emitter.emission);
    cumulative.push_back(total);
  }
  std::vector<shared::Light> lights;
  if (!(total > 0) || count == 0) return lights;
  const Traits traits = scene.traits();
  const double lift = kLift * glm::length(glm::dvec3(traits.boundsMax) - glm::dvec3(traits.boundsMin));

  size_t first = 0;  // the emitter that holds the stratum's start
  for (uint32_t i = 0; i < count; ++i) {
    const double lo = total * i / count, hi = total * (i + 1.0) / count, middle = 0.5 * (lo + hi);
    // The sample carries all that its stratum emits, colour by colour, so that no light is lost or shifted in hue.
    glm::dvec3 power(0.0);
    size_t chosen = first;
    while (first < emitters.size() - 1 && cumulative[first] <= lo) ++first;
    for (size_t e = first; e < emitters.size(); ++e) {
      const double before = e == 0 ? 0.0 : cumulative[e - 1];
      if (before >= hi) break;
      const double share = cumulative[e] - before;
      if (!(share > 0)) continue;
      const double overlap = std::min(hi, cumulative[e]) - std::max(lo, before);
      if (overlap > 0) power += glm::dvec3(emitters[e].emission) * (static_cast<double>(emitters[e].area) * overlap / share);
      if (before <= middle) chosen = e;
    }
    const auto corner = [&](size_t k) {
      return glm::dvec3(scene.vertices[scene.indices[emitters[chosen].triangle * size_t{3} + k]].position);
    };
    // A square folded onto the triangle along its diagonal keeps the sequence's evenness.
    glm::dvec2 p = r2Point(i);
    if (p.x + p.y > 1.0) p = 1.0 - p;
    const glm::dvec3 normal = glm::normalize(areaVector(scene, emitters[chosen].triangle));
    shared::Light light{};
    light.type = shared::kLightEmitterSample;
    light.position = glm::vec3(corner(0) + (corner(1) - corner(0)) * p.x + (corner(2) - corner(0)) * p.y + normal * lift);
    light.direction = glm::vec3(normal);
    light.intensity = glm::vec3(power);
    light.triangle = emitters[chosen].triangle;
    lights.push_back(light);
  }
  return lights;
}

}  // namespace radivox::scene
