// Lights of the traced scene: what there is, and how they are sampled.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/scene/texture.h"
#include "modules/reference/sampler.h"
#include "modules/reference/traced_scene.h"

namespace radivox::reference {

namespace {

class Hash {
 public:
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  void add(const void* data, size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    value_ = combineKeys(value_, bytes);
    for (size_t i = 0; i < bytes; i += 8) {
      uint64_t word = 0;
      for (size_t k = 0; k < 8 && i + k < bytes; ++k) word |= static_cast<uint64_t>(p[i + k]) << (8 * k);
      value_ = combineKeys(value_, word);
    }
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0;
};

glm::dvec3 areaVectorOf(const std::vector<shared::Vertex>& vertices, const uint32_t* corners) {
  const glm::dvec3 p0(vertices[corners[0]].position);
  return 0.5 * glm::cross(glm::dvec3(vertices[corners[1]].position) - p0, glm::dvec3(vertices[corners[2]].position) - p0);
}

}  // namespace

PathTracer::Impl::Impl(const scene::Scene& scene, Sides sides)
    : vertices(scene.vertices),
      indices(scene.indices),
      triangleMaterials(scene.triangleMaterials),
      materials(scene.materials),
      textures(scene.textures),
      sky(scene.skyRadiance),
      skyImage(scene.sky),
      obeysSides(sides == Sides::Gltf && scene.traits().singleSided) {
  listTriangles();
  listLights(scene);
  if (skyImage) skyDistribution = SkyDistribution(*skyImage);
  Hash hash;
  hash.add(vertices);
  hash.add(indices);
  hash.add(triangleMaterials);
  hash.add(materials);
  for (const scene::TextureImage& texture : textures) {
    hash.add(texture.rgba);
    const uint32_t how[] = {texture.width, texture.height, texture.wrapU, texture.wrapV, texture.nearest ? 1u : 0u, texture.srgb ? 1u : 0u};
    hash.add(how, sizeof(how));
  }
  hash.add(lights);
  hash.add(&sky, sizeof(sky));
  if (skyImage) {
    hash.add(skyImage->texels);
    hash.add(&skyImage->width, sizeof(skyImage->width));
    hash.add(&skyImage->turn, sizeof(skyImage->turn));
  }
  hash.add(&obeysSides, sizeof(obeysSides));
  fingerprint = hash.value();
  buildHierarchy();
}

void PathTracer::Impl::listLights(const scene::Scene& scene) {
  double power = 0;
  for (const scene::PunctualLight& from : scene.lights) {
    if (from.intensity == glm::vec3(0.f)) continue;
    lights.push_back({from.type, from.position, glm::normalize(from.direction), from.intensity, from.range, std::cos(from.innerConeAngle),
                      std::cos(from.outerConeAngle)});
    power += static_cast<double>(luminance(from.intensity));
  }
  // Half by power, half evenly: no light is so weak that nobody asks it.
  double cumulative = 0;
  for (const Punctual& light : lights) {
    cumulative += 0.5 / static_cast<double>(lights.size()) + 0.5 * static_cast<double>(luminance(light.intensity)) / power;
    lightShares.push_back(cumulative);
  }

  double total = 0;
  for (uint32_t t = 0; t < triangleMaterials.size(); ++t) {
    if ((materials[triangleMaterials[t]].flags & shared::kMaterialEmissive) == 0u) continue;
    const double share =
        glm::length(areaVectorOf(vertices, &indices[size_t{3} * t])) * static_cast<double>(luminance(scene::meanEmission(scene, t)));
    if (!(share > 0)) {
      hasUnsampledEmitters = true;
      continue;
    }
    total += share;
    emitters.push_back({t, share, total});
  }
  if (emitters.empty()) return;
  emitterDensities.assign(triangleMaterials.size(), 0.f);
  for (Emitter& emitter : emitters) {
    emitter.share /= total;
    emitter.cumulative /= total;
    emitterDensities[emitter.triangle] =
        static_cast<float>(emitter.share / glm::length(areaVectorOf(vertices, &indices[size_t{3} * emitter.triangle])));
  }
}

EmitterPoint PathTracer::Impl::sampleEmitters(double u, double v, double choice) const {
  const auto found =
      std::upper_bound(emitters.begin(), emitters.end() - 1, choice, [](double c, const Emitter& e) { return c < e.cumulative; });
  const uint32_t* corners = &indices[size_t{3} * found->triangle];
  // Two halves of a square folded onto the triangle would tear its strata; this map keeps them whole.
  const double root = std::sqrt(u);
  const glm::vec2 b(static_cast<float>(1.0 - root), static_cast<float>(root * v));
  const glm::vec3 &p0 = vertices[corners[0]].position, &p1 = vertices[corners[1]].position, &p2 = vertices[corners[2]].position;
  EmitterPoint point;
  point.position = (1.f - b.x - b.y) * p0 + b.x * p1 + b.y * p2;
  point.normal = glm::normalize(glm::cross(p1 - p0, p2 - p0));
  point.areaDensity = static_cast<double>(emitterDensities[found->triangle]);
  point.clearance = triangles[found->triangle].clearance;
  point.emission = isThere(found->triangle, b) ? emissionAt(found->triangle, b) : glm::vec3(0.f);
  return point;
}

glm::vec3 PathTracer::Impl::punctualIrradiance(size_t i, const glm::vec3& p, const glm::vec3& n) const {
  const Punctual& light = lights[i];
  if (light.type == shared::kLightDirectional) return light.intensity * std::max(0.f, -glm::dot(n, light.direction));
  const glm::vec3 toP = p - light.position;
  const float r2 = glm::dot(toP, toP);
  if (!(r2 > 0.f)) return glm::vec3(0.f);
  const float r = std::sqrt(r2);
  const glm::vec3 d = toP / r;
  float factor = std::max(0.f, -glm::dot(n, d)) / r2;
  if (light.range > 0.f) {
    const float share = r / light.range;
    factor *= std::clamp(1.f - share * share * share * share, 0.f, 1.f);
  }
  if (light.type == shared::kLightSpot) {
    const float a =
        std::clamp((glm::dot(light.direction, d) - light.cosOuter) / std::max(0.001f, light.cosInner - light.cosOuter), 0.f, 1.f);
    factor *= a * a;
  }
  return light.intensity * factor;
}

}  // namespace radivox::reference
