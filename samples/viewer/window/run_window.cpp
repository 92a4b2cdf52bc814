#include "samples/viewer/window/run_window.h"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "engine/error.h"
#include "samples/cli/interrupt.h"
#include "samples/viewer/panels/gui.h"
#include "samples/viewer/window/events.h"
#include "samples/viewer/window/loop_report.h"
#include "samples/viewer/window/presenter.h"

namespace radivox::viewer {

namespace {

constexpr double kFrameSeconds = 1.0 / 60;  // between frames while something moves
constexpr double kIdleSeconds = 0.25;       // between turns while nothing does
constexpr double kAfterInputSeconds = 0.5;  // frames go on after the last event, so that widgets settle

std::string glfwFault() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

/// GLFW from first to last, and its one window.
class Window {
 public:
  Window(uint32_t width, uint32_t height) {
    if (glfwInit() != GLFW_TRUE)
      throw Error(ErrorCode::Unsupported, "no window: " + glfwFault() + "; set DISPLAY, or use --headless --out FILE");
    if (glfwVulkanSupported() != GLFW_TRUE) {
      glfwTerminate();
      throw Error(ErrorCode::Unsupported, "no window: the display shows no Vulkan images; use --headless --out FILE");
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    handle_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), "radivox", nullptr, nullptr);
    if (handle_ == nullptr) {
      const std::string fault = glfwFault();
      glfwTerminate();
      throw Error(ErrorCode::Unsupported, "no window: " + fault + "; use --headless --out FILE");
    }
  }
  ~Window() {
    glfwDestroyWindow(handle_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  GLFWwindow* handle() const { return handle_; }

 private:
  GLFWwindow* handle_ = nullptr;
};

PresenterOptions presenterOptions(GLFWwindow* window, const cli::Options& options) {
  PresenterOptions presenter;
  presenter.device.index = cli::parseDevice(options.device);
  presenter.device.validation = options.validate;
  uint32_t count = 0;
  const char** extensions = glfwGetRequiredInstanceExtensions(&count);
  presenter.device.instanceExtensions.assign(extensions, extensions + count);
  presenter.device.deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  presenter.makeSurface = [window](VkInstance instance) {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(glfwCreateWindowSurface(instance, window, nullptr, &surface), "glfwCreateWindowSurface");
    return surface;
  };
  presenter.wake = glfwPostEmptyEvent;
  return presenter;
}

/// "radivox: cornell, visibility 40 %" while something is under way, for task bars too; "radivox: cornell" when the picture is the one wanted.
std::string titleOf(const App& app) {
  std::string title = "radivox: " + std::filesystem::path(app.scene).filename().string();
  if (app.isSettled()) return title;
  if (app.status.doing.empty()) return title + ", working";
  return title + ", " + app.status.doing + " " + std::to_string(std::lround(app.status.fraction * 100)) + " %";
}

/// Turns of the event loop until the window closes. Nothing in it waits but for events.
int runLoop(GLFWwindow* window, App& app, Gui& gui, Events& events, Presenter& presenter, LoopReport& report) {
  double lastInput = glfwGetTime(), lastFrame = 0, lastTurn = lastInput;
  // Before the first turn, so that the first picture is asked for at the size it is shown.
  ImGui_ImplGlfw_NewFrame();
  presenter.show(gui.draw(app));
  std::string title;
  bool due = true;  // a frame would show something new
  while (glfwWindowShouldClose(window) == GLFW_FALSE && !gui.wantsToQuit()) {
    if (cli::isInterrupted()) return cli::kInterruptedExitCode;
    const bool busy = due || app.isAnimating() || glfwGetTime() - lastInput < kAfterInputSeconds;
    const double wait = busy ? std::max(kFrameSeconds - (glfwGetTime() - lastFrame), 0.001) : kIdleSeconds;
    report.leave();
    glfwWaitEventsTimeout(wait);
    report.enter();
    presenter.rethrowFailure();
    const double now = glfwGetTime();
    if (std::exchange(events.any, false)) lastInput = now;
    due = app.turn(now - lastTurn, gui.controls()) || due;
    lastTurn = now;
    if (std::string text = titleOf(app); text != title) glfwSetWindowTitle(window, (title = std::move(text)).c_str());
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    const bool wanted = due || app.isAnimating() || now - lastInput < kAfterInputSeconds;
    const bool minimized = width <= 0 || height <= 0;
    if (minimized || !wanted || !presenter.isReady() || now - lastFrame < kFrameSeconds * 0.9) continue;
    ImGui_ImplGlfw_NewFrame();
    presenter.show(gui.draw(app));
    report.drew(app);
    lastFrame = now;
    due = false;
  }
  return 0;
}

}  // namespace

int runWindow(const ViewOptions& viewOptions, const cli::Options& options) {
  if (!options.outputs.empty()) throw Error(ErrorCode::BadInput, "--out: only without a window; add --headless, or press P in it");
  const cli::Size size = cli::parseSize(options.size);
  if (!options.stats.empty()) image::checkWritable(options.stats);
  LoopReport report;
  // What is wrong with the settings is said before a window opens; the worker begins meanwhile.
  App app(viewOptions, options, [] { glfwPostEmptyEvent(); });
  Window window(size.width, size.height);
  Gui gui;
  Events events{&app, &gui};
  watch(window.handle(), events);
  ImGui_ImplGlfw_InitForOther(window.handle(), true);
  Presenter presenter(presenterOptions(window.handle(), options));
  const int code = runLoop(window.handle(), app, gui, events, presenter, report);
  ImGui_ImplGlfw_Shutdown();
  if (!options.stats.empty()) report.write(options.stats, app, presenter);
  if (presenter.validationMessageCount() > 0) {
    throw Error(ErrorCode::DeviceFailed, "--validate: " + std::to_string(presenter.validationMessageCount()) +
                                             " validation messages of the window (above); report this");
  }
  return code;
}

}  // namespace radivox::viewer
