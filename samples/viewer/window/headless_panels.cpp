// The window's frames without a window: for pictures of the panels, and to test them anywhere.
#include <imgui.h>

#include <chrono>
#include <filesystem>
#include <iostream>
#include <thread>

#include "engine/error.h"
#include "samples/cli/interrupt.h"
#include "samples/viewer/panels/gui.h"
#include "samples/viewer/window/painter.h"
#include "samples/viewer/window/run_window.h"

namespace radivox::viewer {

namespace {

constexpr uint32_t kTruthSamples = 32;  // to wait for

/// Nothing better will come: the full picture of the newest view, and samples enough beside it.
bool isFinished(App& app) {
  if (!app.picture || app.picture->preview || !app.status.doing.empty() || app.isAnimating()) return false;
  const View now = app.view();
  const View& shown = app.picture->view;
  if (!(shown.camera == now.camera) || shown.width != now.width || shown.height != now.height || shown.overlay != now.overlay) return false;
  if (!app.truth) return true;
  return !app.truthError().empty() || (app.truthPicture && app.truthPicture->samples >= kTruthSamples);
}

}  // namespace

int runHeadlessPanels(const ViewOptions& viewOptions, const cli::Options& options) {
  if (options.outputs.size() != 1 || std::filesystem::path(options.outputs[0]).extension() != ".png")
    throw Error(ErrorCode::BadInput, "--panels and --truth write one picture; give one --out FILE.png");
  cli::parseWhole("--frames", options.frames, 1, 1);
  image::checkWritable(options.outputs[0]);
  const cli::Size size = cli::parseSize(options.size);
  App app(viewOptions, options, [] {});
  app.showsPanels = viewOptions.panels;
  const std::optional<glm::uvec2> point = app.pointer;
  Gui gui;
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(size.width), static_cast<float>(size.height)};
  io.DeltaTime = 1.f / 60;
  if (point) io.MousePos = {static_cast<float>(point->x), static_cast<float>(point->y)};
  PanelFrame frame = gui.draw(app);
  while (!isFinished(app)) {
    cli::stopIfInterrupted();
    if (app.turn(static_cast<double>(io.DeltaTime), {})) frame = gui.draw(app);
    if (!app.status.error.empty()) throw Error(ErrorCode::BadInput, app.status.error);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (int i = 0; i < 3; ++i) frame = gui.draw(app);  // layouts settle
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = cli::parseDevice(options.device);
  deviceOptions.validation = options.validate;
  const auto device = gpu::Device::create(deviceOptions);
  const Pixels pixels = paintFrame(*device, frame);
  image::writePngBytes(options.outputs[0], pixels.width, pixels.height, 4, pixels.rgba);
  return 0;
}

}  // namespace radivox::viewer
