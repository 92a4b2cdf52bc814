// Path-traced truth beside the picture: a thread that adds sample after sample while nothing changes.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "samples/viewer/picture.h"

namespace radivox::viewer {

struct TruthPicture {
  std::shared_ptr<const Pixels> pixels;
  uint32_t samples = 0;  ///< a pixel
  double noise = 0;      ///< expected relative error, as `radivox reference --target-error` has it; +∞: unknown yet
};

class Truth {
 public:
  /// False where the build has no path tracer.
  static bool isAvailable();

  /// `wake` is called from the thread when there is something to fetch.
  explicit Truth(std::function<void()> wake);
  ~Truth();

  /// Starts anew, unless the wish is the same but for exposure and operator. Light, camera, size and bounces of `view`; sides as its settings
  /// have them.
  void want(std::shared_ptr<const scene::Scene> scene, const View& view, float exposure, bool filmic);
  void rest();  ///< nothing more is wanted
  std::optional<TruthPicture> take();
  std::string error();  ///< why there is no picture; empty: there is or will be

 private:
  struct Wish {
    std::shared_ptr<const scene::Scene> scene;
    View view;
    float exposure = 1.f;
    bool filmic = false;
  };
  void run();
  void trace(const Wish& wish, uint64_t version);
  bool isStale(uint64_t version);

  std::function<void()> wake_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wish> wish_;
  uint64_t version_ = 0, tracedVersion_ = 0;
  std::optional<TruthPicture> picture_;
  std::string error_;
  bool quit_ = false;
  std::thread thread_;
};

/// The tone map's curve on the host: radiance → display-referred linear values (frame.tone_map).
image::Image toneMap(const image::Image& radiance, float exposure, bool filmic);

}  // namespace radivox::viewer
