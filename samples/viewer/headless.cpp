#include "samples/viewer/headless.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "samples/cli/assets.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/progress.h"
#include "samples/viewer/settings.h"

namespace radivox::viewer {

namespace {

glm::uvec2 parsePoint(const std::string& text) {
  const size_t comma = text.find(',');
  if (comma == std::string::npos) throw Error(ErrorCode::BadInput, "--point '" + text + "': give X,Y, as in 320,180");
  return {cli::parseWhole("--point", text.substr(0, comma), 0, cli::kMaxSide),
          cli::parseWhole("--point", text.substr(comma + 1), 0, cli::kMaxSide)};
}

void checkOutputs(const cli::Options& options) {
  for (const std::string& path : options.outputs) {
    const std::string extension = std::filesystem::path(path).extension();
    if (extension != ".exr" && extension != ".png")
      throw Error(ErrorCode::BadInput, "--out '" + path + "': unknown kind of file; end the name in .exr or .png");
    image::checkWritable(frameName(path, 0));
  }
  if (!options.stats.empty()) image::checkWritable(options.stats);
}

/// Prints a warning once the scene is known.
void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::cerr << "radivox: warning: " << line << "\n";
}

}  // namespace

Start startOf(const ViewOptions& view, const cli::Options& options) {
  Start start;
  Settings settings(options);
  start.view.scene = options.scene.empty() ? "builtin:atrium" : options.scene;
  start.session.sky = options.sky;
  start.view.graph = settings.graph();
  start.view.settings = settings.values();
  start.view.bounces = settings.bounces();
  const cli::Size size = cli::parseSize(options.size);
  start.view.width = size.width;
  start.view.height = size.height;
  const std::vector<std::string>& names = overlayNames();
  const auto overlay = std::find(names.begin(), names.end(), view.overlay);
  const std::vector<std::string> aovs = settings.aovs();
  if (overlay != names.end()) {
    start.view.overlay = static_cast<Overlay>(overlay - names.begin());
  } else if (std::find(aovs.begin(), aovs.end(), view.overlay) != aovs.end()) {
    start.view.aov = view.overlay;
  } else {
    std::vector<std::string> all = names;
    all.insert(all.end(), aovs.begin(), aovs.end());
    cli::failUnknown("overlay or AOV", view.overlay, all);
  }
  start.view.blocks = view.blocks;
  start.view.reference = view.reference;
  if (!view.point.empty()) start.view.pointer = parsePoint(view.point);
  if (!view.views.empty()) start.views = readViews(view.views, !view.play.empty());
  if (!view.play.empty()) {
    if (view.views.empty()) throw Error(ErrorCode::BadInput, "--play '" + view.play + "': name the file of the path with --views");
    start.views.findPath(view.play, view.views);
  }
  start.frames = cli::parseWhole("--frames", options.frames, 1, 100000);
  start.session.device.index = cli::parseDevice(options.device);
  start.session.device.validation = options.validate;
  start.session.device.pipelineCacheFile = cli::pipelineCacheFile();
  start.session.modules = options.modules;
  return start;
}

std::string frameName(const std::string& pattern, uint32_t frame) {
  const size_t last = pattern.rfind('#');
  if (last == std::string::npos) return pattern;
  size_t first = last;
  while (first > 0 && pattern[first - 1] == '#') --first;
  std::string number = std::to_string(frame);
  const size_t width = last - first + 1;
  if (number.size() < width) number.insert(0, width - number.size(), '0');
  return pattern.substr(0, first) + number + pattern.substr(last + 1);
}

int runHeadless(const ViewOptions& viewOptions, const cli::Options& options) {
  const auto began = std::chrono::steady_clock::now();
  if (options.outputs.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a .exr or .png file to write");
  checkOutputs(options);
  Start start = startOf(viewOptions, options);
  start.session.previews = false;
  Session session(start.session);
  const scene::Scene scene = scene::loadScene(start.view.scene, options.sky);
  warn(scene.warnings);
  start.view.camera = scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  const CameraPath* path = viewOptions.play.empty() ? nullptr : &start.views.findPath(viewOptions.play, viewOptions.views);

  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  cli::ProgressBar bar;
  Hooks hooks;
  hooks.stop = cli::isInterrupted;
  hooks.progress = [&](std::string_view what, double fraction) { bar.show(what, fraction); };
  Picture last;
  hooks.publish = [&](Picture picture) { last = std::move(picture); };
  for (uint32_t frame = 0; frame < start.frames; ++frame) {
    cli::stopIfInterrupted();
    const double seconds = frame / kFramesPerSecond;
    if (path != nullptr) start.view.camera = path->at(seconds);
    if (start.views.lamps) start.view.lighting = start.views.lamps->at(seconds);
    session.show(start.view, hooks);
    cli::stopIfInterrupted();
    if (!last.remark.empty()) throw Error(ErrorCode::BadInput, "--overlay " + viewOptions.overlay + ": " + last.remark);
    for (const std::string& pattern : options.outputs) {
      if (frame + 1 == start.frames || frameName(pattern, 0) != pattern) session.save(frameName(pattern, frame));
    }
    std::vector<std::string> ran;
    for (const graph::NodeStats& node : last.report->stats.nodes) {
      if (node.ranLastFrame) ran.push_back(node.name);
    }
    frames.push_back({{"ms", last.milliseconds}, {"ran", ran}});
  }
  if (!options.stats.empty()) {
    const double total = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
    nlohmann::ordered_json stats = {{"scene", start.view.scene}, {"device", last.report->device}, {"frames", frames}, {"total_ms", total}};
    if (last.error) stats["error"] = {{"rmse", last.error->rmse}, {"relmse", last.error->relMse}, {"psnr", last.error->psnr}};
    image::writeFileAtomically(options.stats, stats.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }
  const uint32_t messages = session.device().validationMessageCount();
  if (messages > 0) {
    throw Error(ErrorCode::DeviceFailed,
                "--validate: " + std::to_string(messages) + " validation messages (above); the pictures were written, but report this");
  }
  return 0;
}

}  // namespace radivox::viewer
