// Unbiased path tracer on Embree: the truth that every method is measured against (METHODS section 5). Usable without a graph.
//
// what      radiance, and its parts as `radivox render` has them, in pixels or at given points; with the variance of every mean
// light     directional, point and spot lights, emissive triangles (front side), a sky (constant, image); Lambertian surfaces with textures
// estimator next-event estimation, multiple importance sampling of emitters and the sky's image, Russian roulette, no clamping; box filter one pixel wide
// bounces   indirect bounces as in scene::Request: 0 direct light only, 1 light → surface → surface → eye, kAllBounces all of them
// bits      the same for any number of threads, however the work was cut into pauses, checkpoints and resumes
//
// Built only where Embree is found (RADIVOX_REFERENCE; radivox_modules then defines RADIVOX_WITH_REFERENCE for all that link it).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/image/image.h"
#include "engine/scene/scene.h"

namespace radivox::reference {

/// Which sides of a surface are there (docs/data_flow.md, Decisions; `sides` of the nodes).
enum class Sides : uint32_t { Both, Gltf };

/// Asked while working, one call at a time, from any thread.
struct Callbacks {
  std::function<void(double fraction)> progress;  ///< of the pass or probe under way
  std::function<bool()> cancelled;                ///< true: the pass under way is given up
};

struct Settings {
  uint32_t width = 960, height = 540;
  uint32_t bounces = scene::kAllBounces;
  /// Most samples a pixel. Samples come in passes of samplesPerPass; the last pass is whole, so a few more may be taken.
  uint32_t spp = 64;
  uint64_t seed = 0;
  /// Stop after the pass that brings Images::relativeError of `color` to this; 0: never. The whole picture stops, not pixels one by one,
  /// so that a lucky pixel is not kept for being lucky.
  double targetError = 0;
  /// Begin no pass that would end later than this, judged by the passes before it (the first is always made); 0: never. Seconds of
  /// tracing, those before a resume included.
  double timeLimitSeconds = 0;
  /// Power of two; 0: spp / 4, at least 1 and at most 16. The samples of a pass are stratified together, passes are independent; the
  /// variance comes from the spread of passes.
  uint32_t samplesPerPass = 0;
  uint32_t threads = 0;  ///< 0: all
};

/// RGB means over pixel boxes and the variance of these means. A variance is +∞ while fewer than two passes tell.
struct Estimate {
  image::Image mean;
  image::Image variance;
};

/// Names as in `render --aov`. Direct light is light straight from lights, emitters and sky; emission seen by the camera and the sky
/// behind the scene are in color alone. Irradiance is weighed by albedo, channel by channel: at edges too E · ρ/π of the means is the
/// mean of E · ρ/π. Where a pixel reflects nothing it is the plain mean, 0 where a sample meets no surface. Variances are those of
/// the quotients, to first order.
struct Images {
  Estimate color;               ///< radiance, W/(m² sr)
  Estimate direct, indirect;    ///< reflected radiance ρE/π of each, W/(m² sr)
  Estimate irradianceDirect;    ///< E, W/m²
  Estimate irradianceIndirect;  ///< E, W/m²
  Estimate albedo;              ///< ρ
  uint32_t samples = 0;         ///< a pixel
  double seconds = 0;           ///< tracing, all passes

  /// "color", "direct", "indirect", "irradiance_direct", "irradiance_indirect", "albedo". Throws BadInput with the names.
  const Estimate& find(std::string_view aov) const;
  static const std::vector<std::string>& names();
};

/// Expected noise of an estimate: √ mean(σ² / (r² + 0.01·mean(r)²)), the square root of the relMSE that its own noise makes. +∞ while
/// variances are.
double relativeError(const Estimate& estimate);

struct ProbePoint {
  glm::vec3 position{0.f};          ///< metres, relative to Scene::origin
  glm::vec3 normal{0.f, 1.f, 0.f};  ///< unit; light arrives over the hemisphere about it
};
struct ProbeSettings {
  uint32_t bounces = scene::kAllBounces;
  uint32_t spp = 256;  ///< samples a point; in passes as Settings::spp, at least two passes
  uint64_t seed = 0;
  uint32_t samplesPerPass = 0;
  uint32_t threads = 0;
};
/// Irradiance at a point, W/m², and the standard error of each mean.
struct ProbeValue {
  glm::vec3 direct{0.f}, directError{0.f};
  glm::vec3 indirect{0.f}, indirectError{0.f};
};

/// The scene in Embree. Holds all it needs: `scene` may go. Immutable, so any number of threads may use it.
class PathTracer {
 public:
  /// Builds the hierarchy on one thread, since the order of coplanar triangles in it shows in pictures. About a second a million triangles.
  explicit PathTracer(const scene::Scene& scene, Sides sides = Sides::Both);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;

  /// Renders until spp, the target or the time limit is reached. Throws Error(BadInput, "interrupted") when cancelled.
  Images render(const scene::CameraDescription& camera, const Settings& settings, const Callbacks& callbacks = {}) const;
  std::vector<ProbeValue> probe(std::span<const ProbePoint> points, const ProbeSettings& settings, const Callbacks& callbacks = {}) const;

  double buildSeconds() const;
  uint64_t fingerprint() const;  ///< of the scene as lit: a checkpoint of another scene is refused

  struct Impl;  ///< private to modules/reference
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// A picture in the making: for snapshots (error against time from one run), checkpoints and halves. 360 bytes a pixel.
class Rendering {
 public:
  /// `tracer` must outlive it. Throws BadInput (settings), OutOfMemory.
  Rendering(const PathTracer& tracer, const scene::CameraDescription& camera, const Settings& settings);
  ~Rendering();
  Rendering(Rendering&&) noexcept;

  /// One more pass over all pixels. False, and nothing changed, when cancelled.
  bool advance(const Callbacks& callbacks = {});
  /// spp, the target or the time limit is reached.
  bool isDone() const;

  uint32_t samples() const;  ///< a pixel
  uint32_t passes() const;
  double seconds() const;  ///< of all passes
  Images images() const;
  /// Half 0 or 1: the even or the odd passes, independent of each other. Throws BadInput before there are two passes.
  Images half(uint32_t index) const;

  /// The whole state. resume() refuses the state of another scene, camera, size, number of bounces, seed or (where asked for)
  /// samplesPerPass with BadInput naming `source`; spp, target and time limit may differ. A resumed rendering goes on as if it had never
  /// stopped, bit for bit; a samplesPerPass of 0 takes that of the state.
  std::string checkpoint() const;
  void resume(const std::string& state, const std::string& source);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace radivox::reference
