#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>
#include <numbers>

#include "engine/error.h"
#include "modules/reference/accumulator.h"
#include "modules/reference/integrator.h"
#include "modules/reference/rendering_state.h"

namespace radivox::reference {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kTileSide = 16;
/// Powers of two with four passes at least, and large enough for what stratifying gains.
constexpr uint32_t kMostSamplesPerPass = 16;
constexpr uint32_t kMaxSamplesPerPass = 65536;
constexpr float kDarkestAlbedo = 1e-4f;

struct CameraRays {
  explicit CameraRays(const scene::CameraDescription& camera, uint32_t width, uint32_t height) : description(camera) {
    const glm::dmat3 axes = glm::mat3_cast(glm::normalize(glm::dquat(camera.orientation)));
    const double halfHeight = camera.orthographic ? static_cast<double>(camera.ymag) : std::tan(0.5 * static_cast<double>(camera.yfov));
    right = axes[0] * (halfHeight * width / height);
    up = axes[1] * halfHeight;
    forward = -axes[2];
  }
  const scene::CameraDescription& description;
  glm::dvec3 right, up, forward;

  /// x, y in [−1, 1], y down.
  void cast(double x, double y, glm::vec3& origin, glm::vec3& direction, float& tNear, float& tFar) const {
    const glm::dvec3 offset = x * right - y * up;
    if (description.orthographic) {
      origin = glm::vec3(glm::dvec3(description.position) + offset);
      direction = glm::vec3(forward);
      tNear = description.znear;
      tFar = description.zfar;
    } else {
      const glm::dvec3 d = forward + offset;
      const double length = glm::length(d);
      origin = description.position;
      direction = glm::vec3(d / length);
      tNear = static_cast<float>(static_cast<double>(description.znear) * length);
      tFar = kInfinity;
    }
  }
};

void put(Channels& channels, size_t aov, const glm::vec3& value) {
  for (glm::length_t c = 0; c < 3; ++c) channels[3 * aov + static_cast<size_t>(c)] += value[c];
}

}  // namespace

uint32_t choosePassSize(uint32_t asked, uint32_t spp) {
  if (asked == 0) return std::min(std::bit_floor(std::max(spp / 4, 1u)), kMostSamplesPerPass);
  if (!std::has_single_bit(asked) || asked > kMaxSamplesPerPass) {
    throw Error(ErrorCode::BadInput,
                "samplesPerPass " + std::to_string(asked) + ": give a power of two up to " + std::to_string(kMaxSamplesPerPass));
  }
  return asked;
}

namespace {

/// The mean over the samples of one pass in one pixel.
Channels tracePixel(const PathTracer::Impl& scene, const CameraRays& camera, const Settings& settings, uint32_t x, uint32_t y, uint64_t key,
                    uint32_t sampleCount) {
  Channels sum{};
  for (uint32_t i = 0; i < sampleCount; ++i) {
    Sampler sampler(key, i);
    const auto [u, v] = sampler.next2D();
    glm::vec3 origin, direction;
    float tNear = 0, tFar = 0;
    camera.cast((x + u) / settings.width * 2.0 - 1.0, (y + v) / settings.height * 2.0 - 1.0, origin, direction, tNear, tFar);
    Surface surface;
    if (!scene.findSurface(origin, direction, tNear, tFar, surface)) {
      put(sum, 0, scene.skyImage ? scene.sky + scene.skyImage->interpolated(direction) : scene.sky);
      continue;
    }
    const Irradiance e = sampleIrradiance(scene, surface, settings.bounces, sampler);
    const glm::vec3 reflectance = surface.albedo / 3.14159265358979f;
    put(sum, 0, reflectance * (e.direct + e.indirect) + surface.emission);
    put(sum, 1, reflectance * e.direct);
    put(sum, 2, reflectance * e.indirect);
    put(sum, 3, e.direct);
    put(sum, 4, e.indirect);
    put(sum, 5, surface.albedo);
  }
  const float share = 1.f / static_cast<float>(sampleCount);
  for (float& value : sum) value *= share;
  return sum;
}

}  // namespace

Rendering::Rendering(const PathTracer& tracer, const scene::CameraDescription& camera, const Settings& settings)
    : impl_(std::make_unique<Impl>(Impl{tracer, camera, settings})) {
  if (settings.width == 0 || settings.height == 0)
    throw Error(ErrorCode::BadInput, "the picture has no pixels; give a size of at least 1x1");
  if (settings.spp == 0) throw Error(ErrorCode::BadInput, "0 samples a pixel; give at least 1");
  impl_->choosesPassSize = settings.samplesPerPass == 0;
  impl_->settings.samplesPerPass = choosePassSize(settings.samplesPerPass, settings.spp);
  const size_t pixelCount = size_t{settings.width} * settings.height;
  try {
    impl_->pixels.resize(pixelCount);
    impl_->pass.resize(pixelCount);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::OutOfMemory, "no memory for " + std::to_string(settings.width) + "x" + std::to_string(settings.height) +
                                            " pixels of " + std::to_string(sizeof(PixelMoments) + sizeof(Channels)) +
                                            " bytes; choose a smaller size");
  }
}
Rendering::~Rendering() = default;
Rendering::Rendering(Rendering&&) noexcept = default;

bool Rendering::advance(const Callbacks& callbacks) {
  const auto start = std::chrono::steady_clock::now();
  const Settings& settings = impl_->settings;
  const PathTracer::Impl& scene = impl_->tracer.impl();
  const CameraRays camera(impl_->camera, settings.width, settings.height);
  const uint64_t passKey = combineKeys(combineKeys(settings.seed, 0x7069786c), impl_->passes);
  const uint32_t across = (settings.width + kTileSide - 1) / kTileSide, down = (settings.height + kTileSide - 1) / kTileSide;

  std::atomic<bool> cancelled{false};
  std::atomic<uint32_t> doneCount{0};
  std::mutex callbackMutex;
  const auto tell = [&] {
    const uint32_t done = ++doneCount;
    const std::unique_lock lock(callbackMutex, std::try_to_lock);
    if (!lock.owns_lock()) return;
    if (callbacks.progress) callbacks.progress(static_cast<double>(done) / (static_cast<double>(across) * down));
    if (callbacks.cancelled && callbacks.cancelled()) cancelled = true;
  };
  const auto traceTile = [&](uint32_t tile) {
    if (cancelled) return;
    const uint32_t left = tile % across * kTileSide, top = tile / across * kTileSide;
    for (uint32_t y = top; y < std::min(top + kTileSide, settings.height); ++y) {
      for (uint32_t x = left; x < std::min(left + kTileSide, settings.width); ++x) {
        const size_t pixel = size_t{y} * settings.width + x;
        impl_->pass[pixel] = tracePixel(scene, camera, settings, x, y, combineKeys(passKey, pixel), settings.samplesPerPass);
      }
    }
    tell();
  };
  tbb::task_arena(arenaSize(settings.threads)).execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<uint32_t>(0, across * down, 1),
        [&](const tbb::blocked_range<uint32_t>& range) {
          for (uint32_t tile = range.begin(); tile != range.end(); ++tile) traceTile(tile);
        },
        tbb::simple_partitioner());
  });
  if (cancelled) return false;

  const uint32_t half = impl_->passes % 2, count = impl_->passes / 2 + 1;
  for (size_t i = 0; i < impl_->pixels.size(); ++i) impl_->pixels[i].half[half].add(impl_->pass[i], count);
  ++impl_->passes;
  impl_->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  impl_->checkTarget();
  return true;
}

bool Rendering::isDone() const {
  const Settings& settings = impl_->settings;
  if (impl_->passes == 0) return false;
  if (samples() >= settings.spp || impl_->reached) return true;
  const double nextEnd = impl_->seconds * (impl_->passes + 1.0) / impl_->passes;
  return settings.timeLimitSeconds > 0 && nextEnd > settings.timeLimitSeconds;
}

uint32_t Rendering::samples() const { return impl_->passes * impl_->settings.samplesPerPass; }
uint32_t Rendering::passes() const { return impl_->passes; }
double Rendering::seconds() const { return impl_->seconds; }
Images Rendering::images() const { return impl_->collect(0, 2); }
Images Rendering::half(uint32_t index) const {
  if (index > 1) throw Error(ErrorCode::BadInput, "half " + std::to_string(index) + ": there are 0 and 1");
  if (impl_->passes < 2) throw Error(ErrorCode::BadInput, "halves need two passes; give more samples a pixel, or fewer a pass");
  return impl_->collect(index, index + 1);
}

void Rendering::Impl::checkTarget() {
  reached = settings.targetError > 0 && passes >= 2 && relativeError(estimate(0, 0, 2)) <= settings.targetError;
}

uint32_t Rendering::Impl::passesOf(uint32_t half) const { return (passes + 1 - half) / 2; }

Estimate Rendering::Impl::estimate(size_t aov, uint32_t firstHalf, uint32_t endHalf) const {
  Estimate out;
  for (image::Image* image : {&out.mean, &out.variance}) {
    image->width = settings.width;
    image->height = settings.height;
    image->channels = 3;
    image->data.resize(pixels.size() * 3);
  }
  double total = 0;
  for (uint32_t h = firstHalf; h < endHalf; ++h) total += passesOf(h);
  for (size_t i = 0; i < pixels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const size_t channel = 3 * aov + c;
      double mean = 0, squares = 0;
      for (uint32_t h = firstHalf; h < endHalf; ++h) {
        mean += static_cast<double>(pixels[i].half[h].mean[channel]) * passesOf(h);
        squares += static_cast<double>(pixels[i].half[h].squares[channel]);
      }
      mean = total > 0 ? mean / total : 0.0;
      for (uint32_t h = firstHalf; h < endHalf; ++h) {
        const double apart = static_cast<double>(pixels[i].half[h].mean[channel]) - mean;
        squares += passesOf(h) * apart * apart;
      }
      out.mean.data[3 * i + c] = static_cast<float>(mean);
      out.variance.data[3 * i + c] = total > 1 ? static_cast<float>(squares / (total * (total - 1.0))) : kInfinity;
    }
  }
  return out;
}

Estimate Rendering::Impl::irradiance(size_t lights, const Estimate& reflected, const Estimate& albedo, uint32_t firstHalf,
                                     uint32_t endHalf) const {
  Estimate out = estimate(kIrradiance / 3 + lights, firstHalf, endHalf);
  double total = 0;
  for (uint32_t h = firstHalf; h < endHalf; ++h) total += passesOf(h);
  for (size_t i = 0; i < out.mean.data.size(); ++i) {
    if (albedo.mean.data[i] < kDarkestAlbedo) continue;
    const double l = static_cast<double>(reflected.mean.data[i]), rho = static_cast<double>(albedo.mean.data[i]), ratio = l / rho;
    out.mean.data[i] = static_cast<float>(std::numbers::pi * ratio);
    if (!(total > 1)) continue;
    // To first order: the variance of reflected light less what albedo (how much of the pixel is covered, and by what) explains of it.
    double products = 0;
    for (uint32_t h = firstHalf; h < endHalf; ++h) {
      const Moments& half = pixels[i / 3].half[h];
      const size_t c = 3 * lights + i % 3;
      products += static_cast<double>(half.products[c]) +
                  passesOf(h) * (static_cast<double>(half.mean[kDirect + c]) - l) * (static_cast<double>(half.mean[kAlbedo + i % 3]) - rho);
    }
    const double covariance = products / (total * (total - 1.0));
    const double variance = static_cast<double>(reflected.variance.data[i]) - 2 * ratio * covariance +
                            ratio * ratio * static_cast<double>(albedo.variance.data[i]);
    out.variance.data[i] = static_cast<float>(std::max(variance, 0.0) * (std::numbers::pi / rho) * (std::numbers::pi / rho));
  }
  return out;
}

Images Rendering::Impl::collect(uint32_t firstHalf, uint32_t endHalf) const {
  Images images;
  images.color = estimate(0, firstHalf, endHalf);
  images.direct = estimate(kDirect / 3, firstHalf, endHalf);
  images.indirect = estimate(kDirect / 3 + 1, firstHalf, endHalf);
  images.albedo = estimate(kAlbedo / 3, firstHalf, endHalf);
  images.irradianceDirect = irradiance(0, images.direct, images.albedo, firstHalf, endHalf);
  images.irradianceIndirect = irradiance(1, images.indirect, images.albedo, firstHalf, endHalf);
  for (uint32_t h = firstHalf; h < endHalf; ++h) images.samples += passesOf(h) * settings.samplesPerPass;
  images.seconds = passes > 0 ? seconds * images.samples / (static_cast<double>(passes) * settings.samplesPerPass) : 0.0;
  return images;
}

}  // namespace radivox::reference
