// Images, their views, and read-back.
#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/gpu/resources.h"
#include "engine/gpu/staging.h"

namespace radivox::gpu {

bool isDepthFormat(VkFormat format) {
  switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
      return true;
    default:
      return false;
  }
}

uint32_t texelBytes(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8_UNORM:
    case VK_FORMAT_R8_UINT:
      return 1;
    case VK_FORMAT_R8G8_UNORM:
    case VK_FORMAT_R16_UINT:
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_SFLOAT:
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_D16_UNORM_S8_UINT:
      return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_R8G8B8A8_UINT:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_B10G11R11_UFLOAT_PACK32:
    case VK_FORMAT_E5B9G9R9_UFLOAT_PACK32:
    case VK_FORMAT_R16G16_UNORM:
    case VK_FORMAT_R16G16_SNORM:
    case VK_FORMAT_R16G16_UINT:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SINT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
    case VK_FORMAT_D32_SFLOAT:
      return 4;
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R16G16B16A16_UINT:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SINT:
    case VK_FORMAT_R32G32_SFLOAT:
      return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return 16;
    default:
      throw Error(ErrorCode::BadInput, "image format " + std::to_string(format) + " is not one that Radivox reads back");
  }
}

namespace {

VkImageCreateInfo describeImage(Device& device, const std::string& name, const ImageInfo& info) {
  const Capabilities& can = device.capabilities();
  if (info.width == 0 || info.height == 0 || info.layers == 0) {
    throw Error(ErrorCode::BadInput, "image " + name + ": width, height and layers must be at least 1");
  }
  if (info.width > can.maxImageDimension2D || info.height > can.maxImageDimension2D || info.layers > can.maxImageArrayLayers) {
    throw Error(ErrorCode::OutOfMemory, "image " + name + ": " + std::to_string(info.width) + "x" + std::to_string(info.height) + " with " +
                                            std::to_string(info.layers) + " layers, but " + can.deviceName + " allows " +
                                            std::to_string(can.maxImageDimension2D) + " a side and " +
                                            std::to_string(can.maxImageArrayLayers) + " layers; lower the image or shadow map size");
  }
  VkFormatProperties properties{};
  vkGetPhysicalDeviceFormatProperties(device.physicalDevice(), info.format, &properties);
  const VkFormatFeatureFlags has = properties.optimalTilingFeatures;
  if (has == 0) {
    throw Error(ErrorCode::Unsupported, "image " + name + ": " + can.deviceName + " has no format " + std::to_string(info.format));
  }
  VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  if ((has & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT) != 0) usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
  if ((has & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT) != 0 && !isDepthFormat(info.format)) usage |= VK_IMAGE_USAGE_STORAGE_BIT;
  if ((has & VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT) != 0) usage |= VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  if ((has & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0) usage |= VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;

  VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = info.format;
  create.extent = {info.width, info.height, 1};
  create.mipLevels = 1;
  create.arrayLayers = info.layers;
  create.samples = VK_SAMPLE_COUNT_1_BIT;
  create.tiling = VK_IMAGE_TILING_OPTIMAL;
  create.usage = usage;
  create.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  return create;
}

VkImageView makeView(Device& device, VkImage image, const ImageInfo& info, VkImageAspectFlags aspect, VkImageViewType type,
                     uint32_t firstLayer, uint32_t layerCount) {
  VkImageViewCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  create.image = image;
  create.viewType = type;
  create.format = info.format;
  create.subresourceRange = {aspect, 0, 1, firstLayer, layerCount};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device.handle(), &create, nullptr, &view), "vkCreateImageView");
  return view;
}

}  // namespace

Image::Image(Device& device, const std::string& name, const ImageInfo& info)
    : device_(&device), ownsImage_(true), info_(info), name_(name) {
  const VkImageCreateInfo create = describeImage(device, name, info);
  try {
    check(vkCreateImage(device.handle(), &create, nullptr, &image_), "vkCreateImage");
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device.handle(), image_, &needs);
    ownedMemory_ = device.allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, false);
    check(vkBindImageMemory(device.handle(), image_, ownedMemory_, 0), "vkBindImageMemory");
    makeViews();
  } catch (const Error& error) {
    release();
    throw Error(error.code(), "image " + name + ": " + error.what());
  }
}

Image::Image(Device& device, const std::string& name, const ImageInfo& info, VkDeviceMemory memory, VkDeviceSize offset)
    : device_(&device), ownsImage_(true), info_(info), name_(name) {
  const VkImageCreateInfo create = describeImage(device, name, info);
  try {
    check(vkCreateImage(device.handle(), &create, nullptr, &image_), "vkCreateImage");
    check(vkBindImageMemory(device.handle(), image_, memory, offset), "vkBindImageMemory");
    makeViews();
  } catch (const Error& error) {
    release();
    throw Error(error.code(), "image " + name + ": " + error.what());
  }
}

Image::Image(VkImage image, VkImageView view, const ImageInfo& info, VkImageLayout layout_)
    : layout(layout_), image_(image), view_(view), info_(info), name_("host image") {
  // The host's view is of its one layer; images of several layers are sampled only, never rendered to.
  if (info.layers == 1) layerViews_.push_back(view);
}

Image::Image(Image&& other) noexcept { *this = std::move(other); }

Image& Image::operator=(Image&& other) noexcept {
  if (this == &other) return *this;
  release();
  layout = std::exchange(other.layout, VK_IMAGE_LAYOUT_UNDEFINED);
  device_ = std::exchange(other.device_, nullptr);
  image_ = std::exchange(other.image_, VK_NULL_HANDLE);
  view_ = std::exchange(other.view_, VK_NULL_HANDLE);
  layerViews_ = std::exchange(other.layerViews_, {});
  ownedMemory_ = std::exchange(other.ownedMemory_, VK_NULL_HANDLE);
  ownsImage_ = std::exchange(other.ownsImage_, false);
  info_ = other.info_;
  name_ = std::move(other.name_);
  return *this;
}

Image::~Image() { release(); }

void Image::release() noexcept {
  if (ownsImage_) {
    for (VkImageView layerView : layerViews_) {
      if (layerView != view_) vkDestroyImageView(device_->handle(), layerView, nullptr);
    }
    vkDestroyImageView(device_->handle(), view_, nullptr);
    vkDestroyImage(device_->handle(), image_, nullptr);
    device_->free(ownedMemory_);
  }
  layerViews_.clear();
  view_ = VK_NULL_HANDLE;
  image_ = VK_NULL_HANDLE;
  ownedMemory_ = VK_NULL_HANDLE;
  ownsImage_ = false;
}

void Image::makeViews() {
  const bool array = info_.arrayView || info_.layers > 1;
  // A view shows the depth aspect alone: that is what shaders read and what is rendered to.
  view_ = makeView(*device_, image_, info_, aspect(), array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D, 0, info_.layers);
  layerViews_.reserve(info_.layers);
  if (!array) {
    layerViews_.push_back(view_);
  } else {
    for (uint32_t i = 0; i < info_.layers; ++i) {
      layerViews_.push_back(makeView(*device_, image_, info_, aspect(), VK_IMAGE_VIEW_TYPE_2D, i, 1));
    }
  }
  device_->setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image_), name_);
}

VkImageAspectFlags Image::aspect() const { return isDepthFormat(info_.format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT; }

VkMemoryRequirements Image::requirements(Device& device, const ImageInfo& info) {
  const VkImageCreateInfo create = describeImage(device, "of a transient resource", info);
  VkDeviceImageMemoryRequirements query{VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS};
  query.pCreateInfo = &create;
  VkMemoryRequirements2 needs{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceImageMemoryRequirements(device.handle(), &query, &needs);
  return needs.memoryRequirements;
}

VkImageAspectFlags layoutAspects(VkFormat format) {
  switch (format) {
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
      return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
      return isDepthFormat(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  }
}

void recordTransition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

std::vector<std::byte> download(Device& device, Image& from, uint32_t layer) {
  const ImageInfo& info = from.info();
  if (layer >= info.layers) {
    throw Error(ErrorCode::BadInput,
                "download of layer " + std::to_string(layer) + " of image " + from.name() + ", which has " + std::to_string(info.layers));
  }
  const size_t rowBytes = static_cast<size_t>(info.width) * texelBytes(info.format);
  const auto rowsAtOnce = static_cast<uint32_t>(std::clamp<size_t>(kStagingBytes / rowBytes, 1, info.height));
  Buffer staging(device, "download staging", rowBytes * rowsAtOnce, MemoryKind::ReadBack);
  std::vector<std::byte> data(rowBytes * info.height);
  const VkImageLayout found = from.layout == VK_IMAGE_LAYOUT_UNDEFINED ? VK_IMAGE_LAYOUT_GENERAL : from.layout;
  for (uint32_t row = 0; row < info.height; row += rowsAtOnce) {
    const uint32_t rows = std::min(rowsAtOnce, info.height - row);
    device.submitAndWait([&](VkCommandBuffer commands) {
      recordTransition(commands, from.handle(), layoutAspects(info.format), from.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
      VkBufferImageCopy region{};
      region.imageSubresource = {from.aspect(), 0, layer, 1};
      region.imageOffset = {0, static_cast<int32_t>(row), 0};
      region.imageExtent = {info.width, rows, 1};
      vkCmdCopyImageToBuffer(commands, from.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.handle(), 1, &region);
      recordTransition(commands, from.handle(), layoutAspects(info.format), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, found);
      recordFullBarrier(commands);
    });
    from.layout = found;
    std::memcpy(data.data() + row * rowBytes, staging.mapped(), rows * rowBytes);
  }
  return data;
}

}  // namespace radivox::gpu
