#include "samples/viewer/truth.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/error.h"
#include "samples/cli/options.h"

#ifdef RADIVOX_WITH_REFERENCE
#include "modules/reference/path_tracer.h"
#else
#include "samples/cli/missing.h"
#endif

namespace radivox::viewer {

image::Image toneMap(const image::Image& radiance, float exposure, bool filmic) {
  image::Image display = radiance;
  for (float& value : display.data) {
    float x = std::max(value, 0.f) * exposure;
    if (filmic) {
      x = std::min(x, 1e4f);
      x = x * (4.f * x + 0.2f) / (x * (4.f * x + 1.2f) + 0.35f);
    }
    value = std::clamp(x, 0.f, 1.f);
  }
  return display;
}

Truth::Truth(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}

Truth::~Truth() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Truth::want(std::shared_ptr<const scene::Scene> scene, const View& view, float exposure, bool filmic) {
  {
    const std::lock_guard lock(mutex_);
    const bool same = wish_ && wish_->scene == scene && wantsSameLight(wish_->view, view) && wish_->view.camera == view.camera &&
                      wish_->view.width == view.width && wish_->view.height == view.height;
    wish_ = Wish{std::move(scene), view, exposure, filmic};
    if (same) return;
    ++version_;
    picture_.reset();
    error_.clear();
  }
  changed_.notify_all();
}

void Truth::rest() {
  const std::lock_guard lock(mutex_);
  if (!wish_) return;
  wish_.reset();
  ++version_;
  picture_.reset();
}

std::optional<TruthPicture> Truth::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(picture_, std::nullopt);
}

std::string Truth::error() {
  const std::lock_guard lock(mutex_);
  return error_;
}

bool Truth::isStale(uint64_t version) {
  const std::lock_guard lock(mutex_);
  return quit_ || version != version_;
}

void Truth::run() {
  while (true) {
    Wish wish;
    uint64_t version = 0;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return quit_ || (wish_ && tracedVersion_ != version_); });
      if (quit_) return;
      wish = *wish_;
      version = tracedVersion_ = version_;
    }
    try {
      trace(wish, version);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      if (version == version_) error_ = error.what();
    }
    wake_();
  }
}

#ifdef RADIVOX_WITH_REFERENCE

bool Truth::isAvailable() { return true; }

void Truth::trace(const Wish& wish, uint64_t version) {
  scene::Scene scene = *wish.scene;
  if (wish.view.lighting) {
    scene.lights = wish.view.lighting->lights;
    scene.skyRadiance = wish.view.lighting->sky;
  }
  const auto& settings = wish.view.settings;
  const bool gltf = std::any_of(settings.begin(), settings.end(), [](const std::string& s) { return s.ends_with(".sides=gltf"); });
  const reference::PathTracer tracer(scene, gltf ? reference::Sides::Gltf : reference::Sides::Both);
  reference::Settings how;
  how.width = wish.view.width;
  how.height = wish.view.height;
  how.bounces = cli::parseBounces(wish.view.bounces);
  how.spp = 1u << 16;
  how.samplesPerPass = 1;
  reference::Rendering rendering(tracer, wish.view.camera, how);
  reference::Callbacks callbacks;
  callbacks.cancelled = [&] { return isStale(version); };
  while (!rendering.isDone()) {
    if (!rendering.advance(callbacks) || isStale(version)) return;
    // Collecting costs about as much as a sample: often at first, then at each further quarter.
    const uint32_t n = rendering.samples();
    if (n > 8 && n % (std::bit_floor(n) / 4) != 0) continue;
    const reference::Images images = rendering.images();
    TruthPicture picture;
    picture.samples = images.samples;
    picture.noise = reference::relativeError(images.color);
    float exposure = 1.f;
    bool filmic = false;
    {
      const std::lock_guard lock(mutex_);
      if (!wish_ || version != version_) return;
      exposure = wish_->exposure;
      filmic = wish_->filmic;
    }
    picture.pixels = std::make_shared<Pixels>(encodePixels(toneMap(images.color.mean, exposure, filmic)));
    {
      const std::lock_guard lock(mutex_);
      if (version != version_) return;
      picture_ = std::move(picture);
    }
    wake_();
  }
}

#else

bool Truth::isAvailable() { return false; }

void Truth::trace(const Wish&, uint64_t) {
  throw Error(ErrorCode::Unsupported, std::string("this build has no path tracer; ") + cli::kGetPathTracer);
}

#endif

}  // namespace radivox::viewer
