// The engine behind the viewer: takes views, makes pictures. No window, no threads of its own; one thread at a time.
//
//   scene → direct light (the first picture) → preview (cheap settings, a second or two later) → full picture → overlays
//
// A full picture may take long to prepare. Between two of its steps the session looks at the newest view: a camera that moves on is shown
// in the preview meanwhile; a view that wants other light ends the work.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "samples/viewer/method.h"
#include "samples/viewer/overlay.h"
#include "samples/viewer/probe.h"

namespace radivox::viewer {

struct SessionOptions {
  gpu::DeviceOptions device;
  std::vector<std::string> modules;  ///< libraries with more nodes
  std::string sky;                   ///< takes the place of every scene's own; empty: that
  bool previews = true;              ///< false: only full pictures (headless, tests)
};

struct Hooks {
  std::function<View()> newest;                                          ///< null: the view given stays
  std::function<void(Picture)> publish;                                  ///< every picture, the full one last
  std::function<void(std::string_view what, double fraction)> progress;  ///< may be null
  std::function<bool()> stop;                                            ///< null: never
  std::function<void(std::shared_ptr<const scene::Scene>)> sceneLoaded;  ///< may be null
};

class Session {
 public:
  explicit Session(SessionOptions options);
  ~Session();

  /// Publishes pictures of `view` up to the full one. False: given up for a newer view, or stopped. Throws Error when it cannot be
  /// shown (the scene's file, memory, the device); what was shown before can be shown again. Errors of a device that failed: reset().
  bool show(const View& view, const Hooks& hooks);
  /// A new device and nothing on it: after the old one was lost.
  void reset();

  /// Layers of the last full picture, linear; every AOV that the graph has, `color` first. Throws BadInput before there is one.
  std::vector<image::Layer> layers();
  /// Writes the last picture: .png as it was shown, overlay and all; .exr all layers(); .vdb or .nvdb the voxels. Returns a remark on what
  /// the file lacks, empty: nothing. Throws Error.
  std::string save(const std::string& path);
  /// Null before the first show().
  std::shared_ptr<const scene::Scene> scene() const { return loaded_; }
  gpu::Device& device() { return *device_; }
  Method* full() { return full_.get(); }

 private:
  void loadScene(const View& view, const Hooks& hooks);
  View resolve(View view) const;  ///< with the scene's own lights and camera where it names no other
  bool showFrozen(const View& view, const Hooks& hooks);
  void showPreview(const View& view, const Hooks& hooks);
  bool prepareFull(const View& view, const Hooks& hooks);
  bool runFull(const View& view, const Hooks& hooks);
  Picture finish(Method& method, const View& view, bool preview, double milliseconds);
  void paintOverlay(Method& method, const View& view, Picture& picture);
  void compareWithStored(Method& method, const View& view, Picture& picture);

  SessionOptions options_;
  std::unique_ptr<gpu::Device> device_;  ///< outlives all below
  std::shared_ptr<const scene::Scene> loaded_;
  scene::Scene lit_;  ///< `loaded_` with the view's lights
  std::string sceneName_;
  std::unique_ptr<OverlayPainter> overlay_;
  std::unique_ptr<FaceProbe> probe_;
  std::unique_ptr<Method> preview_, full_;
  void publish(Picture picture, const Hooks& hooks);
  Picture shown_;                             ///< the last one whose nodes ran
  std::shared_ptr<const Pixels> lastPixels_;  ///< the last published
  image::Image stored_;                       ///< of Overlay::Error
  std::string storedName_;
};

}  // namespace radivox::viewer
