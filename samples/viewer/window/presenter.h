// Shows frames in a window from a thread of its own, so that the thread of the events never waits for a device or a screen.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "samples/viewer/window/painter.h"
#include "samples/viewer/window/swapchain.h"

namespace radivox::viewer {

struct PresenterOptions {
  gpu::DeviceOptions device;                            ///< with the extensions that the window's surface needs
  std::function<VkSurfaceKHR(VkInstance)> makeSurface;  ///< throws Error
  std::function<void()> wake;                           ///< from the presenter's thread, when a frame is on the screen
};

class Presenter {
 public:
  explicit Presenter(PresenterOptions options);
  ~Presenter();

  /// The newest frame counts. Frames without pixels are not shown.
  void show(PanelFrame frame);
  /// The last frame was taken: another would soon be seen.
  bool isReady();
  uint64_t presentedCount();
  uint64_t recoveryCount();  ///< how often the surface or the device was made anew after a loss
  uint32_t validationMessageCount();
  void rethrowFailure();

  /// Test hook: the next present ends so (VK_ERROR_SURFACE_LOST_KHR, VK_ERROR_OUT_OF_DATE_KHR, VK_ERROR_DEVICE_LOST).
  void injectResult(VkResult result);

 private:
  struct Screen;
  void run();
  void present(const PanelFrame& frame, VkResult injected);
  PresenterOptions options_;
  std::unique_ptr<Screen> screen_;  ///< the thread's own
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<PanelFrame> frame_;
  VkResult injected_ = VK_SUCCESS;
  uint64_t presented_ = 0, recoveries_ = 0;
  uint32_t validationMessages_ = 0;
  std::exception_ptr failure_;
  bool quit_ = false;
  std::thread thread_;
};

}  // namespace radivox::viewer
