#include "samples/viewer/window/painter.h"

#include <algorithm>
#include <cstring>

namespace radivox::viewer {

namespace {

constexpr auto kB = gpu::BindingType::StorageBuffer;

template <class T>
void fill(gpu::Device& device, gpu::Buffer& buffer, const char* name, const std::vector<T>& data) {
  const uint64_t bytes = data.size() * sizeof(T);
  if (!buffer || buffer.bytes() < bytes) {
    buffer = gpu::Buffer();
    buffer = gpu::Buffer(device, name, std::max<uint64_t>(bytes * 3 / 2, 16), gpu::MemoryKind::Upload);
  }
  if (bytes > 0) std::memcpy(buffer.mapped(), data.data(), bytes);
}

}  // namespace

Painter::Painter(gpu::Device& device, VkFormat format) : device_(device), pool_(device) {
  pipeline_ = gpu::Pipeline(device, gpu::RasterPipelineInfo{.vertexShader = "viewer/panels.vert",
                                                            .fragmentShader = "viewer/panels.frag",
                                                            .bindings = {kB, kB, kB},
                                                            .pushConstantBytes = sizeof(shared::PanelPush),
                                                            .colorFormats = {format},
                                                            .blend = true});
}

void Painter::load(const PanelFrame& frame) {
  width_ = frame.width;
  height_ = frame.height;
  draws_ = frame.draws;
  fill(device_, vertices_, "panels.vertices", frame.vertices);
  fill(device_, indices_, "panels.indices", frame.indices);
  for (size_t i = 0; i < kTextureCount; ++i) {
    Texture& texture = textures_[i];
    if (texture.pixels == frame.textures[i]) continue;
    texture.pixels = frame.textures[i];
    if (!texture.pixels) continue;
    const auto& rgba = texture.pixels->rgba;
    if (!texture.texels || texture.texels.bytes() < rgba.size()) {
      texture.texels = gpu::Buffer();
      texture.texels = gpu::Buffer(device_, "panels.texels", rgba.size());
    }
    gpu::upload(device_, texture.texels, rgba);
  }
}

void Painter::record(VkCommandBuffer handle, gpu::Image& target, VkImageLayout after) {
  pool_.reset();
  gpu::Commands commands(device_, handle, pool_);
  commands.barrier();
  const gpu::Commands::Attachment attachment{&target, 0, true, {}};
  commands.beginRendering({target.info().width, target.info().height}, std::span(&attachment, 1), nullptr);
  for (const PanelFrame::Draw& draw : draws_) {
    const Texture& texture = textures_[draw.texture];
    if (!texture.pixels) continue;
    // A window that was resized meanwhile may be smaller than the frame.
    VkRect2D clip = draw.clip;
    const auto limit = [](int32_t at, uint32_t& length, uint32_t side) {
      length = at >= static_cast<int32_t>(side) ? 0 : std::min(length, side - static_cast<uint32_t>(at));
    };
    limit(clip.offset.x, clip.extent.width, target.info().width);
    limit(clip.offset.y, clip.extent.height, target.info().height);
    if (clip.extent.width == 0 || clip.extent.height == 0) continue;
    commands.bind(pipeline_, {vertices_, indices_, texture.texels});
    commands.push(shared::PanelPush{static_cast<float>(width_), static_cast<float>(height_), draw.firstIndex, draw.firstVertex,
                                    texture.pixels->width, texture.pixels->height});
    commands.setScissor(clip);
    commands.draw(draw.indexCount);
  }
  commands.endRendering();
  commands.transition(target, after);
}

Pixels paintFrame(gpu::Device& device, const PanelFrame& frame) {
  Painter painter(device, VK_FORMAT_R8G8B8A8_UNORM);
  gpu::Image target(device, "panels.target", {.width = frame.width, .height = frame.height, .format = VK_FORMAT_R8G8B8A8_UNORM});
  painter.load(frame);
  device.submitAndWait([&](VkCommandBuffer commands) { painter.record(commands, target, VK_IMAGE_LAYOUT_GENERAL); });
  const std::vector<std::byte> bytes = gpu::download(device, target);
  Pixels pixels{frame.width, frame.height, {}};
  pixels.rgba.resize(bytes.size());
  std::memcpy(pixels.rgba.data(), bytes.data(), bytes.size());
  return pixels;
}

}  // namespace radivox::viewer
