// Buffers and images. Move-only owners; or views of memory that someone else owns (graph aliasing, a host's images).
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/device.h"

namespace radivox::gpu {

enum class MemoryKind {
  Device,    ///< device local
  Upload,    ///< host visible and coherent, mapped; device reads
  ReadBack,  ///< host visible and coherent, mapped (cached where there is such a type); device writes
};

/// What a shader takes the texels of an image or a buffer for.
enum class TexelType : uint8_t { Float, Uint, Int };

/// Bytes of a texel as download() lays it out (depth formats: the depth aspect). Throws BadInput for formats Radivox does not use.
uint32_t texelBytes(VkFormat format);
bool isDepthFormat(VkFormat format);

/// Bindings show at most Capabilities::maxStorageBufferRange bytes (128 MiB on lavapipe): what lies beyond in a larger buffer is
/// reached by device address, or by binding pieces of it (BoundResource's offset and range). bytes() is always the whole.
/// Usage of every buffer: storage | uniform texel | transfer src/dst | indirect | uniform | shader device address (+ vertex/index).
class Buffer {
 public:
  Buffer() = default;
  /// Throws OutOfMemory past maxBufferSize. `bytes` 0 becomes 16, so that a binding is always valid.
  Buffer(Device& device, const std::string& name, VkDeviceSize bytes, MemoryKind kind = MemoryKind::Device);
  /// A buffer bound into memory that the caller owns (transient aliasing) and allocated with a device address.
  Buffer(Device& device, const std::string& name, VkDeviceSize bytes, VkDeviceMemory memory, VkDeviceSize offset);
  /// A host's buffer, for imports: usage STORAGE at least. Not destroyed by us. `address` 0: nothing may read it by address. It has no texels().
  Buffer(const std::string& name, VkBuffer buffer, VkDeviceSize bytes, VkDeviceAddress address);
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();

  VkBuffer handle() const { return buffer_; }
  VkDeviceSize bytes() const { return bytes_; }
  VkDeviceAddress address() const { return address_; }
  void* mapped() const { return mapped_; }
  const std::string& name() const { return name_; }
  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }
  /// The whole as texels, for a BindingType::TexelBuffer: Uint as words (R32_UINT), Int as four words (RGBA32_SINT), Float as vec4 (RGBA32F); what is
  /// left over at the end is not in it. Made at the first call. Throws OutOfMemory
  /// where the device's texel buffers are shorter, Unsupported for a host's buffer.
  VkBufferView texels(TexelType type) const;

  static VkMemoryRequirements requirements(Device& device, VkDeviceSize bytes);

 private:
  void release() noexcept;
  Device* device_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  mutable std::array<VkBufferView, 3> texels_{};  ///< by TexelType
  VkDeviceMemory ownedMemory_ = VK_NULL_HANDLE;
  VkDeviceSize bytes_ = 0;
  VkDeviceAddress address_ = 0;
  void* mapped_ = nullptr;
  std::string name_;
};

struct ImageInfo {
  uint32_t width = 1;
  uint32_t height = 1;
  uint32_t layers = 1;  ///< views are 2D for 1 layer unless `arrayView`
  VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
  bool arrayView = false;
  /// Usage, as far as the device allows it for the format. Colour formats: storage | sampled | colour attachment | transfer.
  /// Depth formats: sampled | depth attachment | transfer.
};

class Image {
 public:
  Image() = default;
  Image(Device& device, const std::string& name, const ImageInfo& info);
  Image(Device& device, const std::string& name, const ImageInfo& info, VkDeviceMemory memory, VkDeviceSize offset);
  /// A host's image; its layout at the start of our commands is `layout`. Not destroyed by us (the view is the host's too).
  Image(VkImage image, VkImageView view, const ImageInfo& info, VkImageLayout layout);
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;
  ~Image();

  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }                                     ///< all layers
  VkImageView layerView(uint32_t layer) const { return layerViews_.at(layer); }  ///< one layer, 2D, for rendering
  const ImageInfo& info() const { return info_; }
  VkImageAspectFlags aspect() const;
  const std::string& name() const { return name_; }
  explicit operator bool() const { return image_ != VK_NULL_HANDLE; }

  /// Layout as of the last recorded command. Radivox keeps colour images in GENERAL; depth is attachment or read-only.
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;

  static VkMemoryRequirements requirements(Device& device, const ImageInfo& info);

 private:
  void release() noexcept;
  void makeViews();
  Device* device_ = nullptr;
  VkImage image_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  std::vector<VkImageView> layerViews_;
  VkDeviceMemory ownedMemory_ = VK_NULL_HANDLE;
  bool ownsImage_ = false;
  ImageInfo info_;
  std::string name_;
};

/// Copies through a staging buffer and waits. For scene upload and tests; never per frame.
void upload(Device& device, Buffer& to, std::span<const std::byte> data, VkDeviceSize offset = 0);
std::vector<std::byte> download(Device& device, const Buffer& from, VkDeviceSize offset = 0, VkDeviceSize bytes = VK_WHOLE_SIZE);
/// Tightly packed rows of one layer, top row first. The image's layout is left as found (UNDEFINED becomes GENERAL: there is no way
/// back to it).
std::vector<std::byte> download(Device& device, Image& from, uint32_t layer = 0);

template <class T>
void upload(Device& device, Buffer& to, const std::vector<T>& data) {
  upload(device, to, std::as_bytes(std::span(data)));
}
template <class T>
std::vector<T> downloadAs(Device& device, const Buffer& from, size_t count) {
  auto raw = download(device, from, 0, count * sizeof(T));
  std::vector<T> out(count);
  if (count > 0) std::memcpy(out.data(), raw.data(), count * sizeof(T));
  return out;
}

}  // namespace radivox::gpu
