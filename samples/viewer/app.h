// What a person has chosen and sees: settings, camera, lights, overlays, and the pictures that came of them. Panels and keys change it; once
// a turn of the event loop it takes what the worker has made and asks for what is wanted now. Nothing here waits.
#pragma once

#include "samples/viewer/headless.h"
#include "samples/viewer/settings.h"
#include "samples/viewer/truth.h"
#include "samples/viewer/views_file.h"
#include "samples/viewer/walk.h"
#include "samples/viewer/worker.h"

namespace radivox::viewer {

/// What is held down and how far the mouse has moved, since the last turn.
struct Controls {
  glm::vec3 along{0.f};  ///< right, up, forward
  float turnRight = 0, turnUp = 0;
  bool fast = false;
};

class App {
 public:
  App(const ViewOptions& view, const cli::Options& options, std::function<void()> wake);

  /// `seconds` since the last turn. True: something that panels show has changed.
  bool turn(double seconds, const Controls& controls);
  /// Something moves by itself: more turns are due soon.
  bool isAnimating() const;
  /// Nothing moves; what is wanted is shown and written, or said to be impossible.
  bool isSettled() const { return !isAnimating() && status.idle; }

  // Files dropped onto the window, keys and buttons.
  void open(const std::string& sceneOrFile);  ///< .gltf, .glb, builtin:…; .exr: the picture to compare with; .json: views
  void saveScreenshot();                      ///< .png of what is shown, .exr of every AOV
  static bool canDumpVoxels();                ///< the build has modules/vdb
  void dumpVoxels();                          ///< .vdb of every grid that the picture has made
  void addBookmark();
  void jumpTo(const scene::CameraDescription& camera);
  void startRecording();
  void stopRecording();
  void play(size_t path);
  void stopPlaying() { playing_.reset(); }
  void saveViews();
  void say(const std::string& line);

  Settings settings;
  Walk walk;
  Lamps lamps;
  ViewsFile views;
  std::string viewsPath = "radivox_views.json";
  std::string scene;
  Overlay overlay = Overlay::Picture;
  std::string aov, reference;
  bool blocks = false, frozen = false, truth = false, animate = true, showsPanels = true, showsRays = true;
  std::optional<glm::uvec2> pointer;           ///< pixel of the picture
  uint32_t areaWidth = 640, areaHeight = 360;  ///< for the picture; with the truth beside it, half of that

  // What is there to be seen.
  std::optional<Picture> picture;
  std::optional<TruthPicture> truthPicture;
  Worker::Status status;
  std::vector<std::string> messages;  ///< newest last
  std::shared_ptr<const scene::Scene> loaded;
  bool isRecording() const { return recording_.has_value(); }
  bool isPlaying() const { return playing_.has_value(); }
  std::string truthError();
  Worker& worker() { return worker_; }
  double time() const { return time_; }
  View view() const;  ///< that is wanted now

 private:
  void takeScene();
  bool isSceneHere() const { return loaded && loadedName_ == scene; }
  bool moveCamera(double seconds, const Controls& controls);
  glm::uvec2 pictureSize() const;

  Worker worker_;
  std::unique_ptr<Truth> truth_;
  std::optional<View> wanted_;
  std::string cameraName_, loadedName_;
  double time_ = 0, restSeconds_ = 0;
  bool moving_ = false;
  uint32_t divisor_ = 1;  ///< of the picture's size while something moves
  struct Playing {
    size_t path;
    double seconds;
  };
  std::optional<Playing> playing_;
  std::optional<CameraPath> recording_;
  double recordSeconds_ = 0;
  bool hasViewLamps_ = false;
  std::string firstPath_;
};

/// The size at which a picture that took `milliseconds` would take at most `budget`: a divisor of each side, at most 4.
uint32_t chooseDivisor(double milliseconds, uint32_t divisor, double budget);

}  // namespace radivox::viewer
