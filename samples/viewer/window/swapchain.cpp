#include "samples/viewer/window/swapchain.h"

#include <algorithm>

namespace radivox::viewer {

namespace {

constexpr uint64_t kAcquireNs = 250'000'000;

/// Values are encoded by us: no sRGB format.
VkSurfaceFormatKHR chooseFormat(gpu::Device& device, VkSurfaceKHR surface) {
  uint32_t count = 0;
  gpu::check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physicalDevice(), surface, &count, nullptr),
             "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  gpu::check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physicalDevice(), surface, &count, formats.data()),
             "vkGetPhysicalDeviceSurfaceFormatsKHR");
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM}) {
    for (const VkSurfaceFormatKHR& format : formats) {
      if (format.format == wanted) return format;
    }
  }
  throw Error(ErrorCode::Unsupported, "the window takes no 8-bit RGBA images; use --headless");
}

}  // namespace

VkFormat Swapchain::findFormat(gpu::Device& device, VkSurfaceKHR surface) { return chooseFormat(device, surface).format; }

Swapchain::Swapchain(gpu::Device& device, VkSurfaceKHR surface, VkExtent2D extent) : device_(device), surface_(surface) {
  VkBool32 supported = VK_FALSE;
  gpu::check(vkGetPhysicalDeviceSurfaceSupportKHR(device.physicalDevice(), device.queueFamily(), surface, &supported),
             "vkGetPhysicalDeviceSurfaceSupportKHR");
  if (supported == VK_FALSE) throw Error(ErrorCode::Unsupported, device.capabilities().deviceName + " cannot show this window");
  VkSurfaceCapabilitiesKHR can{};
  gpu::check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physicalDevice(), surface, &can),
             "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  size_ = can.currentExtent;
  if (can.currentExtent.width != ~0u) extent = can.currentExtent;
  extent.width = std::clamp(extent.width, can.minImageExtent.width, can.maxImageExtent.width);
  extent.height = std::clamp(extent.height, can.minImageExtent.height, can.maxImageExtent.height);
  if (extent.width == 0 || extent.height == 0) return;
  const VkSurfaceFormatKHR format = chooseFormat(device, surface);

  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface;
  info.minImageCount = std::max(can.minImageCount, 2u);
  if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
  info.imageFormat = format.format;
  info.imageColorSpace = format.colorSpace;
  info.imageExtent = extent;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = (can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0 ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                                                                                               : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  gpu::check(vkCreateSwapchainKHR(device.handle(), &info, nullptr, &swapchain_), "vkCreateSwapchainKHR");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  gpu::check(vkCreateFence(device.handle(), &fence, nullptr, &fence_), "vkCreateFence");
  uint32_t count = 0;
  gpu::check(vkGetSwapchainImagesKHR(device.handle(), swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  std::vector<VkImage> images(count);
  gpu::check(vkGetSwapchainImagesKHR(device.handle(), swapchain_, &count, images.data()), "vkGetSwapchainImagesKHR");
  for (VkImage image : images) {
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    views_.push_back(VK_NULL_HANDLE);
    gpu::check(vkCreateImageView(device.handle(), &view, nullptr, &views_.back()), "vkCreateImageView");
    images_.emplace_back(image, views_.back(), gpu::ImageInfo{.width = extent.width, .height = extent.height, .format = format.format},
                         VK_IMAGE_LAYOUT_UNDEFINED);
  }
}

Swapchain::~Swapchain() {
  vkQueueWaitIdle(device_.queue());
  for (VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
  vkDestroyFence(device_.handle(), fence_, nullptr);
  vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
}

bool Swapchain::fits() const {
  VkSurfaceCapabilitiesKHR can{};
  // A lost surface shows when an image of it is asked for.
  if (vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physicalDevice(), surface_, &can) != VK_SUCCESS) return true;
  return can.currentExtent.width == size_.width && can.currentExtent.height == size_.height;
}

VkResult Swapchain::acquire(uint32_t& index) {
  const VkResult result = vkAcquireNextImageKHR(device_.handle(), swapchain_, kAcquireNs, VK_NULL_HANDLE, fence_, &index);
  if (result == VK_NOT_READY) return VK_TIMEOUT;
  if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) return result;
  gpu::check(vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  gpu::check(vkResetFences(device_.handle(), 1, &fence_), "vkResetFences");
  images_[index].layout = VK_IMAGE_LAYOUT_UNDEFINED;
  return result;
}

VkResult Swapchain::present(uint32_t index) {
  VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  info.swapchainCount = 1;
  info.pSwapchains = &swapchain_;
  info.pImageIndices = &index;
  return vkQueuePresentKHR(device_.queue(), &info);
}

}  // namespace radivox::viewer
