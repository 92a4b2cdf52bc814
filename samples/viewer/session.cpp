#include "samples/viewer/session.h"

#include <chrono>
#include <cmath>
#include <filesystem>

#include "engine/error.h"
#include "samples/cli/layers.h"
#include "samples/cli/picture.h"
#include "samples/viewer/error_map.h"

namespace radivox::viewer {

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// A full picture that takes longer than this while the camera moves is replaced by the preview.
constexpr double kSlowMs = 120;

/// Previews have no more pixels than this.
constexpr double kPreviewPixels = 200000;

/// Cameras, sizes or overlays differ: worth a preview while the light is at work.
bool looksDifferent(const View& a, const View& b) {
  return !(a.camera == b.camera) || a.width != b.width || a.height != b.height || a.overlay != b.overlay || a.blocks != b.blocks ||
         a.pointer != b.pointer;
}

}  // namespace

Session::Session(SessionOptions options) : options_(std::move(options)) { reset(); }

Session::~Session() = default;

void Session::reset() {
  probe_.reset();
  overlay_.reset();
  preview_.reset();
  full_.reset();
  device_.reset();
  device_ = gpu::Device::create(options_.device);
  overlay_ = nullptr;
}

void Session::loadScene(const View& view, const Hooks& hooks) {
  if (loaded_ && view.scene == sceneName_) return;
  if (hooks.progress) hooks.progress("loading " + view.scene, 0.0);
  auto scene = std::make_shared<scene::Scene>(scene::loadScene(view.scene, options_.sky));
  preview_.reset();
  full_.reset();
  shown_ = {};
  lit_ = *scene;
  loaded_ = std::move(scene);
  sceneName_ = view.scene;
  if (hooks.sceneLoaded) hooks.sceneLoaded(loaded_);
}

View Session::resolve(View view) const {
  if (view.scene != sceneName_) return view;
  if (!view.lighting) view.lighting = Lighting{loaded_->lights, loaded_->skyRadiance};
  if (view.namedCamera) {
    view.camera = loaded_->cameras.front();
    for (size_t i = 0; i < loaded_->cameras.size(); ++i) {
      const scene::CameraDescription& camera = loaded_->cameras[i];
      if (camera.name == *view.namedCamera || std::to_string(i) == *view.namedCamera) view.camera = camera;
    }
    view.namedCamera.reset();
  }
  return view;
}

bool Session::show(const View& wanted, const Hooks& hooks) {
  if (wanted.frozen && showFrozen(wanted, hooks)) return true;
  loadScene(wanted, hooks);
  const View view = resolve(wanted);
  lit_.lights = view.lighting->lights;
  lit_.skyRadiance = view.lighting->sky;
  return prepareFull(view, hooks) && runFull(view, hooks);
}

bool Session::showFrozen(const View& view, const Hooks& hooks) {
  if (!full_ || !full_->isLit() || view.scene != sceneName_) return false;
  // Nothing runs: the picture's own light and camera stay, overlays of voxels are seen from where the viewer is.
  View held = shown_.view;
  held.overlay = view.overlay;
  held.aov = view.aov;
  held.blocks = view.blocks;
  held.pointer = view.pointer;
  held.reference = view.reference;
  held.frozen = true;
  if (view.blocks || view.overlay == Overlay::Voxels) {
    held.camera = view.camera;
    held.width = view.width;
    held.height = view.height;
  }
  const auto start = Clock::now();
  publish(finish(*full_, held, false, millisecondsSince(start)), hooks);
  return true;
}

void Session::showPreview(const View& view, const Hooks& hooks) {
  const auto start = Clock::now();
  View small = view;
  const auto divisor = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(view.width) * view.height / kPreviewPixels)));
  small.width = std::max(view.width / divisor, 1u);
  small.height = std::max(view.height / divisor, 1u);
  if (view.pointer) small.pointer = glm::min(*view.pointer / divisor, glm::uvec2(small.width - 1, small.height - 1));
  if (!shown_.pixels && view.bounces != "0") {
    // The very first of a scene: direct light needs a fifth of the pipelines.
    View direct = small;
    direct.bounces = "0";
    direct.overlay = Overlay::Picture;
    Method method(*device_, lit_, direct, options_.modules, Method::Quality::Preview);
    method.run({}, hooks.stop);
    shown_ = finish(method, direct, true, millisecondsSince(start));
    shown_.view = view;
    publish(shown_, hooks);
  }
  if (preview_ && !preview_->update(lit_, small)) preview_.reset();
  if (!preview_) preview_ = std::make_unique<Method>(*device_, lit_, small, options_.modules, Method::Quality::Preview);
  preview_->run({}, hooks.stop);
  shown_ = finish(*preview_, small, true, millisecondsSince(start));
  shown_.view = view;
  publish(shown_, hooks);
}

bool Session::prepareFull(const View& view, const Hooks& hooks) {
  if (full_ && full_->update(lit_, view)) {
    const bool slow = !full_->isLit() || full_->lastFrameMs() > kSlowMs;
    if (options_.previews && view.moving && slow) {
      showPreview(view, hooks);
      // At rest the full picture follows; until then newer views come first.
      return false;
    }
    return true;
  }
  full_.reset();  // first, so that two of them need not fit
  if (options_.previews) showPreview(view, hooks);
  if (hooks.progress) hooks.progress("pipelines", 0.0);
  full_ = std::make_unique<Method>(*device_, lit_, view, options_.modules, Method::Quality::Full);
  return true;
}

bool Session::runFull(const View& view, const Hooks& hooks) {
  const auto start = Clock::now();
  bool givenUp = false;
  const auto interrupted = [&] {
    if (givenUp || (hooks.stop && hooks.stop())) return givenUp = true;
    if (!hooks.newest || !options_.previews) return false;
    const View newest = resolve(hooks.newest());
    if (!wantsSameLight(newest, view)) return givenUp = true;
    // One camera frame: soon done, and then the newest view's turn comes.
    if (full_->isLit()) return false;
    if (looksDifferent(newest, shown_.view)) showPreview(newest, hooks);
    return false;
  };
  try {
    full_->run(hooks.progress, interrupted);
  } catch (const Error&) {
    if (givenUp) return false;
    full_.reset();
    throw;
  }
  shown_ = finish(*full_, view, false, millisecondsSince(start));
  publish(shown_, hooks);
  return true;
}

void Session::publish(Picture picture, const Hooks& hooks) {
  lastPixels_ = picture.pixels;
  if (hooks.publish) hooks.publish(std::move(picture));
}

Picture Session::finish(Method& method, const View& view, bool preview, double milliseconds) {
  Picture picture;
  picture.view = view;
  picture.preview = preview;
  picture.milliseconds = milliseconds;
  picture.exposure = method.exposure();
  picture.filmic = method.isFilmic();
  picture.report = std::make_shared<GraphReport>(method.report());
  if (view.overlay == Overlay::Error) {
    compareWithStored(method, view, picture);
  } else if (view.overlay != Overlay::Picture) {
    paintOverlay(method, view, picture);
  } else if (!view.aov.empty() && !preview) {
    try {
      picture.pixels = std::make_shared<Pixels>(encodePixels(cli::displayReferred(method.aov(view.aov, *loaded_))));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::BadInput) throw;
      picture.remark = error.what();
    }
  }
  if (!picture.pixels) picture.pixels = std::make_shared<Pixels>(method.display());
  return picture;
}

void Session::paintOverlay(Method& method, const View& view, Picture& picture) {
  const Ports ports = method.ports();
  picture.remark = OverlayPainter::findFault(ports, view.overlay);
  if (!picture.remark.empty()) return;
  if (!overlay_) overlay_ = std::make_unique<OverlayPainter>(*device_);
  if (!probe_) probe_ = std::make_unique<FaceProbe>(*device_);
  overlay_->findFaces(ports, view.camera, view.width, view.height, view.blocks || view.overlay == Overlay::Voxels);
  const bool canProbe = OverlayPainter::findFault(ports, Overlay::VisibleClusters).empty();
  if (view.pointer && canProbe) {
    if (const std::optional<uint32_t> face = overlay_->faceAt(*view.pointer))
      picture.pointed = std::make_shared<PointedFace>(probe_->read(ports, *face));
  }
  picture.pixels = std::make_shared<Pixels>(overlay_->paint(ports, view.overlay, picture.exposure, picture.pointed.get()));
}

void Session::compareWithStored(Method& method, const View& view, Picture& picture) {
  if (view.reference.empty()) {
    picture.remark = "no stored picture to compare with; choose an .exr file";
    return;
  }
  try {
    if (storedName_ != view.reference) {
      stored_ = cli::takeLayer(cli::readPicture(view.reference), "color");
      storedName_ = view.reference;
    }
    const image::Layer color = method.aov("color", *loaded_);
    if (color.image.width != stored_.width || color.image.height != stored_.height) {
      picture.remark = view.reference + " has " + std::to_string(stored_.width) + "x" + std::to_string(stored_.height) +
                       " pixels, this picture " + std::to_string(color.image.width) + "x" + std::to_string(color.image.height);
      return;
    }
    picture.error = std::make_shared<image::Comparison>(image::compare(image::truthOf(stored_), color.image));
    picture.pixels = std::make_shared<Pixels>(encodePixels(paintError(stored_, color.image)));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::BadInput) throw;
    picture.remark = error.what();
  }
}

std::vector<image::Layer> Session::layers() {
  if (!full_ || !full_->isLit()) throw Error(ErrorCode::BadInput, "there is no full picture yet; wait for it");
  std::vector<image::Layer> layers;
  for (const std::string& name : full_->aovNames()) {
    image::Layer layer = full_->aov(name, *loaded_);
    layers.insert(name == "color" ? layers.begin() : layers.end(), std::move(layer));
  }
  return layers;
}

std::string Session::save(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension();
  if (extension == ".exr") {
    image::writeExr(path, layers());
  } else if (extension == ".png") {
    if (!lastPixels_) throw Error(ErrorCode::BadInput, "there is no picture yet; wait for it");
    image::writePngBytes(path, lastPixels_->width, lastPixels_->height, 4, lastPixels_->rgba);
  } else if (extension == ".vdb" || extension == ".nvdb") {
    if (!full_ || !full_->isLit()) throw Error(ErrorCode::BadInput, "there is no full picture yet; wait for it");
    return full_->dumpVoxels(path, *loaded_);
  } else {
    throw Error(ErrorCode::BadInput, "'" + path + "': unknown kind of file; end the name in .exr or .png");
  }
  return {};
}

}  // namespace radivox::viewer
