#include "samples/viewer/overlay.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numbers>

#include "shaders/viewer/overlay.h"

namespace radivox::viewer {

namespace {

using gpu::BindingType;
constexpr auto kB = BindingType::StorageBuffer;
constexpr auto kI = BindingType::StorageImage;

/// Bindings 0 … 5 of clustered_voxel/structure.glsl.
constexpr std::array<std::pair<const char*, const char*>, 6> kStructure = {{
    {"clustered_voxel.voxelize", "grid"},
    {"clustered_voxel.voxelize", "occupancy"},
    {"clustered_voxel.index", "rank"},
    {"clustered_voxel.faces", "mask"},
    {"clustered_voxel.faces", "first"},
    {"clustered_voxel.surface", "faces"},
}};

struct Source {
  const char* type;
  const char* port;
};

/// Where an overlay's values come from.
Source valuesOf(Overlay overlay) {
  if (overlay == Overlay::DirectIrradiance) return {"clustered_voxel.inject", "face_irradiance"};
  return {"clustered_voxel.gather", "irradiance"};
}

bool showsValues(Overlay overlay) { return overlay == Overlay::DirectIrradiance || overlay == Overlay::IndirectIrradiance; }

uint32_t modeOf(Overlay overlay) {
  switch (overlay) {
    case Overlay::Clusters:
      return shared::kPaintClusters;
    case Overlay::ClusterNormals:
      return shared::kPaintClusterNormals;
    case Overlay::DirectIrradiance:
    case Overlay::IndirectIrradiance:
      return shared::kPaintValues;
    case Overlay::VisibleClusters:
      return shared::kPaintMarks;
    default:
      return shared::kPaintAlbedo;
  }
}

/// Large enough for `bytes`; contents are lost when it grows.
void reserve(gpu::Device& device, gpu::Buffer& buffer, const char* name, uint64_t bytes, gpu::MemoryKind kind) {
  if (buffer && buffer.bytes() >= bytes) return;
  buffer = gpu::Buffer();
  buffer = gpu::Buffer(device, name, bytes, kind);
}

}  // namespace

OverlayPainter::OverlayPainter(gpu::Device& device) : device_(device), pool_(device) {
  surface_ = gpu::Pipeline(
      device, gpu::ComputePipelineInfo{
                  .shader = "viewer/surface_faces.comp", .bindings = {kB, kB, kB, kB, kB, kB, kI, kI, kB}, .pushConstantBytes = 12});
  cast_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "viewer/cast_faces.comp", .bindings = {kB, kB, kB, kB, kB, kB, kB, kB}});
  paint_ = gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "viewer/paint.comp",
                                                          .bindings = {kB, kI, kB, kB, kB, kB, kB, kB, kB},
                                                          .pushConstantBytes = sizeof(shared::PaintPush)});
}

std::string OverlayPainter::findFault(const Ports& ports, Overlay overlay) {
  for (const auto& [type, port] : kStructure) {
    if (ports.buffer(type, port) == nullptr) return "this plan has no voxels: there is no " + std::string(type) + " in it";
  }
  if (overlay == Overlay::Clusters || overlay == Overlay::ClusterNormals || overlay == Overlay::VisibleClusters) {
    if (ports.buffer("clustered_voxel.cluster", "labels") == nullptr || ports.buffer("clustered_voxel.members", "places") == nullptr)
      return "this plan has no clusters";
  }
  if (overlay == Overlay::VisibleClusters && ports.buffer("clustered_voxel.visibility", "row_start") == nullptr)
    return "this plan counts no visibility";
  if (showsValues(overlay)) {
    const Source source = valuesOf(overlay);
    if (ports.buffer(source.type, source.port) == nullptr) return "this plan has no " + std::string(source.type);
  }
  return {};
}

void OverlayPainter::submit(const std::function<void(gpu::Commands&)>& record) {
  pool_.reset();
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device_, handle, pool_);
    commands.barrier();
    record(commands);
    commands.barrier();
  });
}

void OverlayPainter::findFaces(const Ports& ports, const scene::CameraDescription& camera, uint32_t width, uint32_t height, bool blocks) {
  const gpu::Image* position = ports.image("frame.gbuffer", "position");
  const gpu::Image* normal = ports.image("frame.gbuffer", "normal");
  blocks_ = blocks || position == nullptr || normal == nullptr;
  width_ = blocks_ ? width : position->info().width;
  height_ = blocks_ ? height : position->info().height;
  const uint64_t count = uint64_t{width_} * height_;
  reserve(device_, pixels_, "viewer.pixels", count * 8, gpu::MemoryKind::Device);
  reserve(device_, texels_, "viewer.texels", count * 4, gpu::MemoryKind::Device);
  const shared::Camera seen = scene::makeCamera(camera, width_, height_);
  reserve(device_, camera_, "viewer.camera", sizeof(seen), gpu::MemoryKind::Upload);
  std::memcpy(camera_.mapped(), &seen, sizeof(seen));
  std::vector<gpu::BoundResource> bindings;
  for (const auto& [type, port] : kStructure) bindings.emplace_back(*ports.buffer(type, port));
  submit([&](gpu::Commands& commands) {
    if (blocks_) {
      bindings.emplace_back(camera_);
      bindings.emplace_back(pixels_);
      commands.bind(cast_, bindings);
    } else {
      bindings.emplace_back(*position);
      bindings.emplace_back(*normal);
      bindings.emplace_back(pixels_);
      commands.bind(surface_, bindings);
      struct {
        uint32_t width, height;
        float pixelAngle;
      } push{width_, height_, seen.orthographic != 0 ? 0.f : seen.pixelAngle};
      commands.push(push);
    }
    commands.dispatchItems(count, 64);
  });
}

std::optional<uint32_t> OverlayPainter::faceAt(const glm::uvec2& pixel) {
  if (!pixels_ || pixel.x >= width_ || pixel.y >= height_) return {};
  const std::vector<std::byte> raw = gpu::download(device_, pixels_, (uint64_t{pixel.y} * width_ + pixel.x) * 8, 8);
  uint32_t id = 0;
  std::memcpy(&id, raw.data(), sizeof(id));
  if (id == 0 || id == ~0u) return {};
  return id - 1;
}

void OverlayPainter::setMarks(const PointedFace* pointed, uint64_t clusterCount, uint64_t faceCount) {
  const uint64_t bytes = (clusterCount + faceCount) * sizeof(float);
  if (!marks_ || marks_.bytes() < bytes) {
    reserve(device_, marks_, "viewer.marks", bytes, gpu::MemoryKind::Upload);
    std::memset(marks_.mapped(), 0, bytes);
    marked_.clear();
  }
  auto* marks = static_cast<float*>(marks_.mapped());
  for (const size_t at : marked_) marks[at] = 0.f;
  marked_.clear();
  if (pointed == nullptr) return;
  const auto mark = [&](size_t at, uint32_t rays) {
    marks[at] = static_cast<float>(rays) / static_cast<float>(std::max(pointed->rayCount, 1u));
    marked_.push_back(at);
  };
  for (const auto& [cluster, rays] : pointed->clusters) mark(cluster, rays);
  for (const auto& [face, rays] : pointed->faces) mark(clusterCount + face, rays);
}

Pixels OverlayPainter::paint(const Ports& ports, Overlay overlay, float exposure, const PointedFace* pointed) {
  const gpu::Buffer none;
  const gpu::Image noImage;
  const auto orNone = [&](const gpu::Buffer* buffer) -> const gpu::Buffer& { return buffer != nullptr ? *buffer : none; };
  gpu::Image* picture = ports.image("frame.tone_map", "display");
  const bool hasPicture = !blocks_ && picture != nullptr && picture->info().width == width_ && picture->info().height == height_;
  const uint64_t clusterCount = ports.count("clusters"), faceCount = ports.count("faces");
  setMarks(overlay == Overlay::VisibleClusters ? pointed : nullptr, clusterCount, faceCount);
  float most = 0.f;
  for (const size_t at : marked_) most = std::max(most, static_cast<const float*>(marks_.mapped())[at]);

  shared::PaintPush push{};
  push.width = width_;
  push.height = height_;
  push.mode = modeOf(overlay);
  push.clusterCount = static_cast<uint32_t>(clusterCount);
  push.valueStride = overlay == Overlay::IndirectIrradiance ? 4 : 3;
  push.pointedFace = pointed != nullptr ? pointed->id + 1 : 0;
  push.scale = exposure / std::numbers::pi_v<float>;
  push.markScale = most > 0.f ? 1.f / most : 0.f;
  push.hasPicture = hasPicture ? 1 : 0;
  const gpu::Buffer* values = nullptr;
  const gpu::Buffer* valid = nullptr;
  if (showsValues(overlay)) {
    values = ports.buffer(valuesOf(overlay).type, valuesOf(overlay).port);
    if (overlay == Overlay::IndirectIrradiance) valid = ports.buffer("clustered_voxel.gather", "valid");
  }
  push.usesValid = valid != nullptr ? 1 : 0;
  submit([&](gpu::Commands& commands) {
    commands.bind(paint_, {pixels_, hasPicture ? *picture : noImage, *ports.buffer("clustered_voxel.surface", "faces"),
                           orNone(ports.buffer("clustered_voxel.cluster", "labels")),
                           orNone(ports.buffer("clustered_voxel.members", "places")), orNone(values), orNone(valid), marks_, texels_});
    commands.push(push);
    commands.dispatchItems(uint64_t{width_} * height_, 64);
  });
  Pixels pixels{width_, height_, {}};
  const std::vector<std::byte> bytes = gpu::download(device_, texels_, 0, uint64_t{width_} * height_ * 4);
  pixels.rgba.resize(bytes.size());
  std::memcpy(pixels.rgba.data(), bytes.data(), bytes.size());
  return pixels;
}

}  // namespace radivox::viewer
