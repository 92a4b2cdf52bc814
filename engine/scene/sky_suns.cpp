#include "engine/scene/sky_suns.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/text.h"

namespace radivox::scene {

namespace {

constexpr double kPi = 3.14159265358979323846;
/// How far above the mean of the rest a sun is. What is less bright than that is found by one ray in sixteen of those that its light comes by.
constexpr double kContrast = 16;
/// All that stands out together takes no more than this, sr: two cells of pixels' rays. Wider patches are found by rays.
constexpr double kMostSolidAngle = 0.02;
constexpr double kLeastShare = 0.01;  ///< of the image's flux; less is not worth a shadow map
constexpr size_t kMostSuns = 4;

double luminanceOf(const glm::vec3& c) {
  return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
}

/// The luminance above which texels stand out.
double findLimit(const Sky& sky, const std::vector<double>& luminance, const std::vector<double>& solidAngles) {
  // Mean of what is left when texels are cut to kContrast times that mean.
  double mean = 0;
  for (size_t i = 0; i < luminance.size(); ++i) mean += luminance[i] * solidAngles[i / sky.width] / (4 * kPi);
  for (int step = 0; step < 64; ++step) {
    double cut = 0;
    for (size_t i = 0; i < luminance.size(); ++i) cut += std::min(luminance[i], kContrast * mean) * solidAngles[i / sky.width] / (4 * kPi);
    const bool settled = cut > mean * (1 - 1e-6);
    mean = cut;
    if (settled) break;
  }
  std::vector<uint32_t> bright;
  for (size_t i = 0; i < luminance.size(); ++i) {
    if (luminance[i] > kContrast * mean) bright.push_back(static_cast<uint32_t>(i));
  }
  std::stable_sort(bright.begin(), bright.end(), [&](uint32_t a, uint32_t b) { return luminance[a] > luminance[b]; });
  double solidAngle = 0;
  for (const uint32_t i : bright) {
    solidAngle += solidAngles[i / sky.width];
    if (solidAngle > kMostSolidAngle) return luminance[i];
  }
  return kContrast * mean;
}

struct Patch {
  std::vector<uint32_t> texels;
  double flux = 0;             ///< luminance above the limit, over solid angle
  glm::dvec3 irradiance{0.0};  ///< the same, RGB
  glm::dvec3 towards{0.0};     ///< Σ flux · direction
};

/// Neighbours by side or corner, around the image's edge and across neither pole.
Patch growPatch(const Sky& sky, uint32_t first, const std::vector<double>& luminance, double limit, std::vector<bool>& seen) {
  Patch patch;
  patch.texels.push_back(first);
  seen[first] = true;
  for (size_t next = 0; next < patch.texels.size(); ++next) {
    const uint32_t i = patch.texels[next], x = i % sky.width, y = i / sky.width;
    const double excess = (1 - limit / luminance[i]) * sky.solidAngle(y);
    patch.flux += excess * luminance[i];
    patch.irradiance += excess * glm::dvec3(sky.texels[i]);
    patch.towards += excess * luminance[i] * sky.direction((x + 0.5) / sky.width, (y + 0.5) / sky.height);
    for (uint32_t row = y == 0 ? 0 : y - 1; row <= std::min(y + 1, sky.height - 1); ++row) {
      for (uint32_t step = 0; step < 3; ++step) {
        const uint32_t neighbour = row * sky.width + (x + sky.width - 1 + step) % sky.width;
        if (seen[neighbour] || !(luminance[neighbour] > limit)) continue;
        seen[neighbour] = true;
        patch.texels.push_back(neighbour);
      }
    }
  }
  return patch;
}

}  // namespace

std::vector<glm::vec3> takeOutSuns(Sky& sky, const std::string& name) {
  std::vector<double> luminance, solidAngles;
  for (const glm::vec3& texel : sky.texels) luminance.push_back(luminanceOf(texel));
  for (uint32_t y = 0; y < sky.height; ++y) solidAngles.push_back(sky.solidAngle(y));
  double total = 0;
  for (size_t i = 0; i < luminance.size(); ++i) total += luminance[i] * solidAngles[i / sky.width];
  const double limit = findLimit(sky, luminance, solidAngles);

  std::vector<Patch> patches;
  std::vector<bool> seen(luminance.size());
  for (size_t i = 0; i < luminance.size(); ++i) {
    if (seen[i] || !(luminance[i] > limit)) continue;
    Patch patch = growPatch(sky, static_cast<uint32_t>(i), luminance, limit, seen);
    if (patch.flux >= kLeastShare * total) patches.push_back(std::move(patch));
  }
  std::stable_sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.flux > b.flux; });
  if (patches.size() > kMostSuns) patches.resize(kMostSuns);

  std::vector<glm::vec3> calm = sky.texels;
  for (const Patch& patch : patches) {
    for (const uint32_t i : patch.texels) calm[i] *= static_cast<float>(limit / luminance[i]);
    PunctualLight sun;
    sun.name = "sun of the sky";
    sun.direction = glm::vec3(-glm::normalize(patch.towards));
    sun.intensity = glm::vec3(patch.irradiance);
    sky.suns.push_back(sun);
    sky.sunShare += patch.flux / total;
  }
  if (!sky.suns.empty()) {
    sky.notes.push_back(name + ": " + (sky.suns.size() == 1 ? "a sun" : std::to_string(sky.suns.size()) + " suns") + " with " +
                        printNumber(100 * sky.sunShare, 3) + " % of its light became " +
                        (sky.suns.size() == 1 ? "a directional light" : "directional lights") + "; ?sun=keep leaves it to the rays");
  }
  return calm;
}

}  // namespace radivox::scene
