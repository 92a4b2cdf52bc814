// Irradiance at points.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>

#include "engine/error.h"
#include "modules/reference/integrator.h"
#include "modules/reference/rendering_state.h"

namespace radivox::reference {

namespace {

struct Sums {
  glm::dvec3 mean{0.0}, squares{0.0};
  void add(const glm::dvec3& value, double count) {
    const glm::dvec3 before = value - mean;
    mean += before / count;
    squares += before * (value - mean);
  }
  glm::vec3 error(double count) const { return glm::vec3(glm::sqrt(squares / (count * (count - 1.0)))); }
};

ProbeValue probePoint(const PathTracer::Impl& scene, const ProbePoint& point, const ProbeSettings& settings, uint64_t key,
                      uint32_t passSize, uint32_t passCount) {
  Surface surface;
  surface.position = point.position;
  surface.geometric = surface.shading = glm::normalize(point.normal);
  surface.clearance = clearanceOf(scene.largestCoordinate);
  Sums direct, indirect;
  for (uint32_t pass = 0; pass < passCount; ++pass) {
    const uint64_t passKey = combineKeys(key, pass);
    glm::dvec3 directSum(0.0), indirectSum(0.0);
    for (uint32_t i = 0; i < passSize; ++i) {
      Sampler sampler(passKey, i);
      const Irradiance e = sampleIrradiance(scene, surface, settings.bounces, sampler);
      directSum += glm::dvec3(e.direct);
      indirectSum += glm::dvec3(e.indirect);
    }
    direct.add(directSum / static_cast<double>(passSize), pass + 1.0);
    indirect.add(indirectSum / static_cast<double>(passSize), pass + 1.0);
  }
  return {glm::vec3(direct.mean), direct.error(passCount), glm::vec3(indirect.mean), indirect.error(passCount)};
}

}  // namespace

std::vector<ProbeValue> PathTracer::probe(std::span<const ProbePoint> points, const ProbeSettings& settings,
                                          const Callbacks& callbacks) const {
  if (settings.spp < 2) throw Error(ErrorCode::BadInput, "a probe needs at least 2 samples a point to know its error");
  for (size_t i = 0; i < points.size(); ++i) {
    const float length2 = glm::dot(points[i].normal, points[i].normal);
    if (!(length2 > 0.f) || !std::isfinite(length2) || !std::isfinite(glm::dot(points[i].position, points[i].position)))
      throw Error(ErrorCode::BadInput, "probe point " + std::to_string(i) + " has no finite position and normal; give both");
  }
  const uint32_t passSize = std::min(choosePassSize(settings.samplesPerPass, settings.spp), std::bit_floor(settings.spp / 2));
  const uint32_t passCount = (settings.spp + passSize - 1) / passSize;
  const uint64_t key = combineKeys(settings.seed, 0x70726f6265);

  std::vector<ProbeValue> values(points.size());
  std::atomic<bool> cancelled{false};
  std::atomic<size_t> doneCount{0};
  std::mutex callbackMutex;
  tbb::task_arena(arenaSize(settings.threads)).execute([&] {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 4), [&](const tbb::blocked_range<size_t>& range) {
      for (size_t i = range.begin(); i != range.end() && !cancelled; ++i) {
        values[i] = probePoint(*impl_, points[i], settings, combineKeys(key, i), passSize, passCount);
        const size_t done = ++doneCount;
        const std::unique_lock lock(callbackMutex, std::try_to_lock);
        if (!lock.owns_lock()) continue;
        if (callbacks.progress) callbacks.progress(static_cast<double>(done) / static_cast<double>(points.size()));
        if (callbacks.cancelled && callbacks.cancelled()) cancelled = true;
      }
    });
  });
  if (cancelled) throw Error(ErrorCode::BadInput, "interrupted");
  return values;
}

}  // namespace radivox::reference
