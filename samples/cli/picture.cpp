#include "samples/cli/picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "engine/error.h"

namespace radivox::cli {

namespace {

constexpr float kDarkestAlbedo = 1e-4f;

bool isId(const std::string& name) { return name == "face" || name == "cluster"; }

/// Every channel of the image as float.
image::Image toFloats(const std::vector<std::byte>& bytes, const gpu::ImageInfo& info, const std::string& endpoint) {
  image::Image result;
  result.width = info.width;
  result.height = info.height;
  const size_t pixelCount = static_cast<size_t>(info.width) * info.height;
  const auto fill = [&](uint32_t channels, auto convert) {
    result.channels = channels;
    result.data.resize(pixelCount * channels);
    for (size_t i = 0; i < result.data.size(); ++i) result.data[i] = convert(i);
  };
  const auto word = [&bytes](size_t i) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + i * 4, 4);
    return value;
  };
  const auto single = [&bytes](size_t i) {
    float value = 0.f;
    std::memcpy(&value, bytes.data() + i * 4, 4);
    return value;
  };
  switch (info.format) {
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      fill(4, single);
      break;
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_D32_SFLOAT:
      fill(1, single);
      break;
    case VK_FORMAT_R32_UINT:
      fill(1, [&](size_t i) { return static_cast<float>(word(i)); });
      break;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      fill(4, [&](size_t i) {
        uint16_t half = 0;
        std::memcpy(&half, bytes.data() + i * 2, 2);
        return glm::unpackHalf1x16(half);
      });
      break;
    case VK_FORMAT_R8G8B8A8_UNORM:
      // Display images hold sRGB-encoded bytes; files hold linear values.
      fill(4, [&](size_t i) {
        const float value = static_cast<float>(std::to_integer<uint8_t>(bytes[i])) / 255.f;
        return i % 4 == 3 ? value : image::decodeSrgb(value);
      });
      break;
    default:
      throw Error(ErrorCode::Unsupported, endpoint + ": its image format (" + std::to_string(info.format) +
                                              ") cannot be written to a file; give an AOV of 32-bit or 16-bit float");
  }
  return result;
}

image::Image takeChannels(const image::Image& from, uint32_t first, uint32_t count) {
  image::Image result{from.width, from.height, count, {}};
  const size_t pixelCount = static_cast<size_t>(from.width) * from.height;
  result.data.resize(pixelCount * count);
  for (size_t i = 0; i < pixelCount; ++i) {
    for (uint32_t c = 0; c < count; ++c) result.data[i * count + c] = from.data[i * from.channels + first + c];
  }
  return result;
}

/// Surface points get the scene's origin; the sky (w = 0) stays 0.
void addOrigin(image::Image& position, const glm::dvec3& origin) {
  for (size_t i = 0; i + 3 < position.data.size(); i += 4) {
    if (position.data[i + 3] == 0.f) continue;
    for (int c = 0; c < 3; ++c) {
      float& value = position.data[i + static_cast<size_t>(c)];
      value = static_cast<float>(static_cast<double>(value) + origin[c]);
    }
  }
}

image::Image firstOfBlocks(const image::Image& from, uint32_t k) {
  image::Image result{from.width / k, from.height / k, from.channels, {}};
  for (uint32_t y = 0; y < result.height; ++y) {
    for (uint32_t x = 0; x < result.width; ++x) {
      for (uint32_t c = 0; c < from.channels; ++c) result.data.push_back(from.at(x * k, y * k, c));
    }
  }
  return result;
}

/// Means of irradiance weighed by albedo, channel by channel, so that E · ρ/π of the means is the mean of E · ρ/π at edges too; plain
/// means where all samples are black.
image::Image meansByAlbedo(const image::Image& irradiance, const image::Image& albedo, uint32_t k) {
  image::Image reflected = irradiance;
  for (size_t i = 0; i < reflected.data.size(); ++i) reflected.data[i] *= albedo.data[i];
  reflected = image::blockMeans(reflected, k);
  const image::Image weights = image::blockMeans(albedo, k);
  image::Image means = image::blockMeans(irradiance, k);
  for (size_t i = 0; i < means.data.size(); ++i) {
    if (weights.data[i] >= kDarkestAlbedo) means.data[i] = reflected.data[i] / weights.data[i];
  }
  return means;
}

/// A colour for an id, far from its neighbours' colours; black for 0 (nothing there).
image::Image paintIds(const image::Image& ids) {
  image::Image result{ids.width, ids.height, 3, {}};
  for (const float id : ids.data) {
    auto hash = static_cast<uint32_t>(id) * 2654435761u;
    hash ^= hash >> 15;
    hash *= 2246822519u;
    for (int c = 0; c < 3; ++c) {
      result.data.push_back(id == 0.f ? 0.f : image::decodeSrgb(0.2f + 0.8f * static_cast<float>((hash >> (8 * c)) & 255u) / 255.f));
    }
  }
  return result;
}

/// The AOV as the executor holds it, `Job::supersample` times as large as the picture.
image::Image downloadWhole(gpu::Device& device, graph::Executor& executor, const Aov& aov, const scene::Scene& scene) {
  gpu::Image* source = executor.findImage(aov.endpoint);
  if (source == nullptr) {
    throw Error(ErrorCode::BadInput,
                "AOV " + aov.name + ": " + aov.endpoint + " is no image of this plan; `radivox graph` prints what was left out and why");
  }
  image::Image whole = toFloats(gpu::download(device, *source), source->info(), aov.endpoint);
  if (aov.name == "position" && whole.channels == 4) addOrigin(whole, scene.origin);
  if (aov.channel < 0) return whole.channels == 4 ? takeChannels(whole, 0, 3) : whole;
  if (static_cast<uint32_t>(aov.channel) >= whole.channels) {
    throw Error(ErrorCode::BadInput, "AOV " + aov.name + ": " + aov.endpoint + " has " + std::to_string(whole.channels) +
                                         " channels; name one of these in the graph's aovs");
  }
  return takeChannels(whole, static_cast<uint32_t>(aov.channel), 1);
}

}  // namespace

image::Layer downloadAov(gpu::Device& device, graph::Executor& executor, const Job& job, const Aov& aov, const scene::Scene& scene) {
  if (aov.endpoint.empty()) {
    image::Layer black{aov.name, {job.size.width, job.size.height, 3, {}}};
    black.image.data.resize(static_cast<size_t>(job.size.width) * job.size.height * 3);
    return black;
  }
  image::Image whole = downloadWhole(device, executor, aov, scene);
  if (job.supersample == 1) return {aov.name, std::move(whole)};
  if (isId(aov.name)) return {aov.name, firstOfBlocks(whole, job.supersample)};
  if (isIrradiance(aov.name) && job.albedo)
    return {aov.name, meansByAlbedo(whole, downloadWhole(device, executor, *job.albedo, scene), job.supersample)};
  return {aov.name, image::blockMeans(whole, job.supersample)};
}

std::vector<image::Layer> arrangeLayers(std::vector<image::Layer> layers) {
  if (layers.size() == 1) {
    image::Layer& only = layers[0];
    only.name = "color";
    if (only.image.channels == 1) {
      image::Image grey{only.image.width, only.image.height, 3, {}};
      grey.data.reserve(only.image.data.size() * 3);
      for (const float value : only.image.data) grey.data.insert(grey.data.end(), 3, value);
      only.image = std::move(grey);
    }
  }
  return layers;
}

image::Image displayReferred(const image::Layer& layer) {
  if (isId(layer.name)) return paintIds(layer.image);
  if (layer.name == "albedo" || layer.name == "display") return layer.image;
  if (layer.name == "normal") {
    image::Image encoded = layer.image;
    for (float& value : encoded.data) value = image::decodeSrgb(std::clamp(0.5f + 0.5f * value, 0.f, 1.f));
    return encoded;
  }
  return image::scaled(layer.image, image::exposureOf(layer.image));
}

void writePreview(const std::string& path, const image::Layer& layer) { image::writePng(path, displayReferred(layer)); }

}  // namespace radivox::cli
