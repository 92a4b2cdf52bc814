// The images of a window's surface. Every call may find the surface changed or lost, and says so.
#pragma once

#include "engine/gpu/resources.h"

namespace radivox::viewer {

class Swapchain {
 public:
  /// `extent` where the surface leaves it open. Throws Error(Unsupported) where the device cannot show this surface.
  Swapchain(gpu::Device& device, VkSurfaceKHR surface, VkExtent2D extent);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  static VkFormat findFormat(gpu::Device& device, VkSurfaceKHR surface);

  bool isEmpty() const { return swapchain_ == VK_NULL_HANDLE; }  ///< the window has no pixels now
  /// False: the window has another size by now, and the images would not fill it.
  bool fits() const;
  /// The next image to draw to, once it is free. VK_TIMEOUT: none is for now.
  VkResult acquire(uint32_t& index);
  gpu::Image& image(uint32_t index) { return images_[index]; }
  /// What was drawn to it is done.
  VkResult present(uint32_t index);

 private:
  gpu::Device& device_;
  VkSurfaceKHR surface_;
  VkExtent2D size_{};  ///< the surface's when the images were made; ~0: it leaves that open
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  std::vector<VkImageView> views_;
  std::vector<gpu::Image> images_;
};

}  // namespace radivox::viewer
