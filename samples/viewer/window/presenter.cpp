#include "samples/viewer/window/presenter.h"

namespace radivox::viewer {

/// All that a loss may take away, in the order in which it is made.
struct Presenter::Screen {
  std::unique_ptr<gpu::Device> device;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  std::unique_ptr<Painter> painter;
  std::unique_ptr<Swapchain> swapchain;

  ~Screen() {
    dropSurface();
    painter.reset();
  }
  void dropSurface() {
    swapchain.reset();
    if (surface != VK_NULL_HANDLE) vkDestroySurfaceKHR(device->instance(), surface, nullptr);
    surface = VK_NULL_HANDLE;
  }
};

Presenter::Presenter(PresenterOptions options) : options_(std::move(options)) {
  thread_ = std::thread([this] {
    try {
      run();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    screen_.reset();
    options_.wake();
  });
}

Presenter::~Presenter() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Presenter::show(PanelFrame frame) {
  if (frame.width == 0 || frame.height == 0) return;
  {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
  }
  changed_.notify_all();
}

bool Presenter::isReady() {
  const std::lock_guard lock(mutex_);
  return !frame_.has_value();
}

uint64_t Presenter::presentedCount() {
  const std::lock_guard lock(mutex_);
  return presented_;
}

uint64_t Presenter::recoveryCount() {
  const std::lock_guard lock(mutex_);
  return recoveries_;
}

uint32_t Presenter::validationMessageCount() {
  const std::lock_guard lock(mutex_);
  return validationMessages_;
}

void Presenter::rethrowFailure() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void Presenter::injectResult(VkResult result) {
  const std::lock_guard lock(mutex_);
  injected_ = result;
}

void Presenter::run() {
  constexpr uint32_t kMostFailures = 3;  // in a row
  uint32_t failures = 0;
  while (true) {
    PanelFrame frame;
    VkResult injected = VK_SUCCESS;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return quit_ || frame_.has_value(); });
      if (quit_) return;
      frame = std::move(*frame_);
      frame_.reset();
      injected = std::exchange(injected_, VK_SUCCESS);
    }
    while (true) {
      try {
        present(frame, std::exchange(injected, VK_SUCCESS));
        failures = 0;
        break;
      } catch (const Error& error) {
        // Whatever it was, a new device may do.
        if (error.code() != ErrorCode::DeviceFailed || ++failures > kMostFailures) throw;
        screen_.reset();
        const std::lock_guard lock(mutex_);
        ++recoveries_;
        if (quit_) return;
      }
    }
    options_.wake();
  }
}

void Presenter::present(const PanelFrame& frame, VkResult injected) {
  if (!screen_) {
    screen_ = std::make_unique<Screen>();
    screen_->device = gpu::Device::create(options_.device);
  }
  Screen& screen = *screen_;
  for (uint32_t attempt = 0; attempt < 4; ++attempt) {
    if (screen.surface == VK_NULL_HANDLE) screen.surface = options_.makeSurface(screen.device->instance());
    if (!screen.painter) screen.painter = std::make_unique<Painter>(*screen.device, Swapchain::findFormat(*screen.device, screen.surface));
    // A window need not say that it was resized when an image is shown.
    if (screen.swapchain && !screen.swapchain->fits()) screen.swapchain.reset();
    if (!screen.swapchain)
      screen.swapchain = std::make_unique<Swapchain>(*screen.device, screen.surface, VkExtent2D{frame.width, frame.height});
    if (screen.swapchain->isEmpty()) {  // minimized: another frame comes when it is not
      screen.swapchain.reset();
      return;
    }
    uint32_t index = 0;
    VkResult result = screen.swapchain->acquire(index);
    if (result == VK_TIMEOUT) continue;
    if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) {
      screen.painter->load(frame);
      gpu::Image& target = screen.swapchain->image(index);
      screen.device->submitAndWait(
          [&](VkCommandBuffer commands) { screen.painter->record(commands, target, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR); });
      result = screen.swapchain->present(index);
      if (injected != VK_SUCCESS) result = std::exchange(injected, VK_SUCCESS);
      if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) {
        const std::lock_guard lock(mutex_);
        ++presented_;
        validationMessages_ = screen.device->validationMessageCount();
      }
    }
    if (result == VK_SUCCESS) return;
    if (result == VK_SUBOPTIMAL_KHR || result == VK_ERROR_OUT_OF_DATE_KHR) {
      screen.swapchain.reset();
      if (result == VK_SUBOPTIMAL_KHR) return;
    } else if (result == VK_ERROR_SURFACE_LOST_KHR) {
      screen.dropSurface();
      const std::lock_guard lock(mutex_);
      ++recoveries_;
    } else {
      gpu::check(result, "vkQueuePresentKHR");
    }
  }
}

}  // namespace radivox::viewer
