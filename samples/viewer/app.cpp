#include "samples/viewer/app.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/error.h"
#include "samples/cli/missing.h"

namespace radivox::viewer {

namespace {

constexpr double kRestSeconds = 0.25;     // after that a view is at rest
constexpr double kPictureBudgetMs = 80;   // while something moves
constexpr double kKeySeconds = 1.0 / 30;  // between keys of a recorded path
constexpr size_t kMostMessages = 50;

std::string freeName(const std::string& stem, const std::string& extension) {
  for (uint32_t i = 1;; ++i) {
    const std::string name = stem + std::to_string(i);
    if (!std::filesystem::exists(name + extension)) return name;
  }
}

}  // namespace

uint32_t chooseDivisor(double milliseconds, uint32_t divisor, double budget) {
  const double whole = milliseconds * divisor * divisor;
  for (uint32_t d = 1; d < 4; ++d) {
    if (whole / (d * d) <= budget) return d;
  }
  return 4;
}

App::App(const ViewOptions& viewOptions, const cli::Options& options, std::function<void()> wake)
    : settings(options), worker_(startOf(viewOptions, options).session, wake), cameraName_(options.camera), firstPath_(viewOptions.play) {
  const Start start = startOf(viewOptions, options);
  scene = start.view.scene;
  overlay = start.view.overlay;
  aov = start.view.aov;
  blocks = start.view.blocks;
  reference = start.view.reference;
  pointer = start.view.pointer;
  truth = viewOptions.truth;
  views = start.views;
  if (!viewOptions.views.empty()) viewsPath = viewOptions.views;
  hasViewLamps_ = views.lamps.has_value();
  if (truth && !Truth::isAvailable())
    throw Error(ErrorCode::Unsupported, std::string("--truth: this build has no path tracer; ") + cli::kGetPathTracer);
  truth_ = std::make_unique<Truth>(std::move(wake));
}

void App::say(const std::string& line) {
  messages.push_back(line);
  if (messages.size() > kMostMessages) messages.erase(messages.begin());
}

glm::uvec2 App::pictureSize() const {
  const uint32_t width = truth ? areaWidth / 2 : areaWidth;
  return {std::max(width / (moving_ ? divisor_ : 1), 16u), std::max(areaHeight / (moving_ ? divisor_ : 1), 16u)};
}

View App::view() const {
  View view;
  view.scene = scene;
  view.graph = settings.graph();
  view.settings = settings.values();
  view.bounces = settings.bounces();
  if (isSceneHere()) {
    view.camera = walk.camera();
    view.lighting = lamps.at(time_);
  } else {
    view.namedCamera = cameraName_;
    if (hasViewLamps_) view.lighting = views.lamps->at(time_);
  }
  const glm::uvec2 size = pictureSize();
  view.width = size.x;
  view.height = size.y;
  view.overlay = overlay;
  view.aov = aov;
  view.blocks = blocks;
  view.frozen = frozen;
  view.moving = moving_;
  view.reference = reference;
  if (pointer && overlay == Overlay::VisibleClusters) view.pointer = *pointer / (moving_ ? divisor_ : 1);
  return view;
}

void App::takeScene() {
  loaded = status.scene;
  loadedName_ = scene;
  const scene::CameraDescription* camera = &loaded->cameras.front();
  try {
    if (!cameraName_.empty()) camera = &scene::findCamera(*loaded, cameraName_);
  } catch (const Error& error) {
    say(error.what());
  }
  cameraName_.clear();
  walk = Walk(*camera, walkingSpeed(*loaded));
  lamps = hasViewLamps_ ? *views.lamps : Lamps::of(*loaded);
  hasViewLamps_ = false;
  for (const std::string& warning : loaded->warnings) say(warning);
  if (firstPath_.empty()) return;
  for (size_t i = 0; i < views.paths.size(); ++i) {
    if (views.paths[i].name == firstPath_) play(i);
  }
  firstPath_.clear();
}

bool App::moveCamera(double seconds, const Controls& controls) {
  if (playing_) {
    const CameraPath& path = views.paths[playing_->path];
    playing_->seconds += seconds;
    walk.jump(path.at(playing_->seconds));
    if (playing_->seconds >= path.seconds()) playing_.reset();
    return true;
  }
  const bool moves = controls.along != glm::vec3(0.f) || controls.turnRight != 0 || controls.turnUp != 0;
  if (moves) {
    if (controls.turnRight != 0 || controls.turnUp != 0) walk.turn(controls.turnRight, controls.turnUp);
    walk.move(controls.along * (controls.fast ? 4.f : 1.f), static_cast<float>(std::min(seconds, 0.1)));
  }
  if (recording_) {
    recordSeconds_ += seconds;
    if (recordSeconds_ - recording_->keys.back().seconds >= kKeySeconds) recording_->keys.push_back({recordSeconds_, walk.camera()});
  }
  return moves;
}

bool App::turn(double seconds, const Controls& controls) {
  bool changed = false;
  worker_.rethrowFailure();
  Worker::Status before = std::exchange(status, worker_.status());
  for (const std::string& line : status.saved) say(line);
  if (!status.error.empty() && status.error != before.error) say(status.error);
  changed = status.doing != before.doing || status.idle != before.idle || std::abs(status.fraction - before.fraction) > 0.01 ||
            status.error != before.error || !status.saved.empty();
  if (std::optional<Picture> fresh = worker_.takePicture()) {
    if (fresh->view.moving) divisor_ = chooseDivisor(fresh->milliseconds, divisor_, kPictureBudgetMs);
    if (!fresh->remark.empty() && (!picture || picture->remark != fresh->remark)) say(fresh->remark);
    picture = std::move(fresh);
    changed = true;
  }
  if (status.scene && status.scene != loaded && status.sceneName == scene) takeScene();

  if (animate && !frozen && lamps.isMoving()) time_ += seconds;
  const bool moves = isSceneHere() && (moveCamera(seconds, controls) || (animate && !frozen && lamps.isMoving()));
  restSeconds_ = moves ? 0 : restSeconds_ + seconds;
  const bool wasMoving = moving_;
  moving_ = moves || (moving_ && restSeconds_ < kRestSeconds);
  const View now = view();
  const bool sameLook = wanted_ && wantsSameLight(now, *wanted_) && now.camera == wanted_->camera &&
                        now.namedCamera == wanted_->namedCamera && now.width == wanted_->width && now.height == wanted_->height &&
                        now.overlay == wanted_->overlay && now.aov == wanted_->aov && now.blocks == wanted_->blocks &&
                        now.frozen == wanted_->frozen && now.moving == wanted_->moving && now.pointer == wanted_->pointer &&
                        now.reference == wanted_->reference;
  if (!sameLook) {
    worker_.want(now);
    status.idle = false;
    wanted_ = now;
    changed = true;
  }
  if (truth && isSceneHere() && picture && !picture->preview && !moving_ && !frozen) {
    truth_->want(loaded, now, picture->exposure, picture->filmic);
  } else if (!truth || moving_) {
    truth_->rest();
    if (!truth) truthPicture.reset();
  }
  if (std::optional<TruthPicture> fresh = truth_->take()) {
    truthPicture = std::move(fresh);
    changed = true;
  }
  return changed || moves || wasMoving != moving_;
}

bool App::isAnimating() const { return moving_ || playing_ || recording_ || (animate && !frozen && lamps.isMoving()); }

std::string App::truthError() { return truth_->error(); }

void App::open(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension();
  if (extension == ".exr") {
    reference = path;
    overlay = Overlay::Error;
  } else if (extension == ".json") {
    try {
      views = readViews(path, true);
      viewsPath = path;
      if (views.lamps && loaded) lamps = *views.lamps;
    } catch (const Error& error) {
      say(error.what());
    }
  } else {
    scene = path;
    playing_.reset();
    recording_.reset();
    frozen = false;
  }
}

void App::saveScreenshot() {
  const std::string png = freeName("radivox_", ".png");
  worker_.save(png + ".png");
  worker_.save(png + ".exr");
}

bool App::canDumpVoxels() {
#ifdef RADIVOX_WITH_VDB
  return true;
#else
  return false;
#endif
}

void App::dumpVoxels() { worker_.save(freeName("radivox_", ".vdb") + ".vdb"); }

void App::addBookmark() {
  views.bookmarks.push_back({"view " + std::to_string(views.bookmarks.size() + 1), walk.camera()});
  saveViews();
}

void App::jumpTo(const scene::CameraDescription& camera) {
  playing_.reset();
  walk.jump(camera);
}

void App::startRecording() {
  playing_.reset();
  recordSeconds_ = 0;
  recording_ = CameraPath{"path " + std::to_string(views.paths.size() + 1), {{0.0, walk.camera()}}};
}

void App::stopRecording() {
  if (!recording_) return;
  if (recordSeconds_ > recording_->keys.back().seconds) recording_->keys.push_back({recordSeconds_, walk.camera()});
  views.paths.push_back(std::move(*recording_));
  recording_.reset();
  saveViews();
}

void App::play(size_t path) {
  recording_.reset();
  if (path < views.paths.size()) playing_ = Playing{path, 0.0};
}

void App::saveViews() {
  views.scene = scene;
  views.lamps = lamps;
  try {
    writeViews(viewsPath, views);
    say(viewsPath);
  } catch (const Error& error) {
    say(error.what());
  }
}

}  // namespace radivox::viewer
