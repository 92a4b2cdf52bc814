#include "engine/scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace radivox::scene {

namespace {

float decode(float encoded) { return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f); }

const std::array<float, 256>& srgbTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (size_t i = 0; i < 256; ++i) t[i] = decode(static_cast<float>(i) / 255.f);
    return t;
  }();
  return table;
}

/// The code whose decoded value is nearest in encoded space: the last whose lower rounding border is not above `linear`.
uint8_t encodeNearest(float linear) {
  static const std::array<float, 255> borders = [] {
    std::array<float, 255> b{};
    for (size_t i = 0; i < 255; ++i) b[i] = decode((static_cast<float>(i) + 0.5f) / 255.f);
    return b;
  }();
  return static_cast<uint8_t>(std::upper_bound(borders.begin(), borders.end(), linear) - borders.begin());
}

uint8_t toByte(float linear) { return static_cast<uint8_t>(std::clamp(linear, 0.f, 1.f) * 255.f + 0.5f); }

struct Level {
  uint32_t width = 0, height = 0;
  std::vector<glm::vec4> texels;  ///< linear
};

/// Source texels that texel i of a row of `to` covers in a row of `from`, with weights that sum to 1.
void boxWeights(uint32_t from, uint32_t to, uint32_t i, uint32_t& first, std::array<float, 4>& weights, uint32_t& count) {
  const double scale = static_cast<double>(from) / to;
  const double lo = i * scale, hi = std::min((i + 1) * scale, static_cast<double>(from));
  first = static_cast<uint32_t>(lo);
  count = 0;
  for (uint32_t k = first; k < from && k < hi && count < 4; ++k) {
    const double overlap = std::min(hi, k + 1.0) - std::max(lo, static_cast<double>(k));
    if (overlap <= 1e-9) break;
    weights[count++] = static_cast<float>(overlap / scale);
  }
}

Level halve(const Level& from) {
  Level to;
  to.width = std::max(from.width / 2, 1u);
  to.height = std::max(from.height / 2, 1u);
  to.texels.resize(static_cast<size_t>(to.width) * to.height);
  std::array<float, 4> wx{}, wy{};
  for (uint32_t y = 0; y < to.height; ++y) {
    uint32_t firstY = 0, countY = 0;
    boxWeights(from.height, to.height, y, firstY, wy, countY);
    for (uint32_t x = 0; x < to.width; ++x) {
      uint32_t firstX = 0, countX = 0;
      boxWeights(from.width, to.width, x, firstX, wx, countX);
      glm::vec4 sum(0.f);
      for (uint32_t j = 0; j < countY; ++j) {
        for (uint32_t i = 0; i < countX; ++i)
          sum += from.texels[static_cast<size_t>(firstY + j) * from.width + firstX + i] * (wx[i] * wy[j]);
      }
      to.texels[static_cast<size_t>(y) * to.width + x] = sum;
    }
  }
  return to;
}

glm::vec4 decodeTexel(const TextureImage& image, size_t texel) {
  const uint8_t* p = image.rgba.data() + texel * 4;
  glm::vec4 out;
  for (glm::length_t c = 0; c < 4; ++c) out[c] = image.srgb && c < 3 ? srgbTable()[p[c]] : static_cast<float>(p[c]) / 255.f;
  return out;
}

uint32_t wrap(int64_t i, uint32_t size, uint32_t mode) {
  const auto n = static_cast<int64_t>(size);
  if (mode == shared::kWrapClamp) return static_cast<uint32_t>(std::clamp<int64_t>(i, 0, n - 1));
  const int64_t period = mode == shared::kWrapMirror ? 2 * n : n;
  const int64_t j = ((i % period) + period) % period;
  return static_cast<uint32_t>(j < n ? j : period - 1 - j);
}

}  // namespace

MipChain buildMipChain(const TextureImage& image) {
  MipChain chain;
  Level level{image.width, image.height, {}};
  level.texels.resize(static_cast<size_t>(image.width) * image.height);
  for (size_t i = 0; i < level.texels.size(); ++i) {
    level.texels[i] = decodeTexel(image, i);
    const uint8_t* p = image.rgba.data() + i * 4;
    chain.texels.push_back(static_cast<uint32_t>(p[0]) | static_cast<uint32_t>(p[1]) << 8 | static_cast<uint32_t>(p[2]) << 16 |
                           static_cast<uint32_t>(p[3]) << 24);
  }
  chain.levelCount = 1;
  while (level.width > 1 || level.height > 1) {
    level = halve(level);
    ++chain.levelCount;
    for (const glm::vec4& c : level.texels) {
      uint32_t texel = static_cast<uint32_t>(toByte(c.a)) << 24;
      for (glm::length_t k = 0; k < 3; ++k) texel |= static_cast<uint32_t>(image.srgb ? encodeNearest(c[k]) : toByte(c[k])) << (8 * k);
      chain.texels.push_back(texel);
    }
  }
  return chain;
}

glm::vec4 sampleTexture(const TextureImage& image, const glm::vec2& uv) {
  const glm::vec2 at = uv * glm::vec2(image.width, image.height) - (image.nearest ? 0.f : 0.5f);
  const glm::vec2 low = glm::floor(at), f = at - low;
  const auto x = static_cast<int64_t>(low.x), y = static_cast<int64_t>(low.y);
  const auto fetch = [&](int64_t i, int64_t j) {
    return decodeTexel(image, static_cast<size_t>(wrap(j, image.height, image.wrapV)) * image.width + wrap(i, image.width, image.wrapU));
  };
  if (image.nearest) return fetch(x, y);
  return glm::mix(glm::mix(fetch(x, y), fetch(x + 1, y), f.x), glm::mix(fetch(x, y + 1), fetch(x + 1, y + 1), f.x), f.y);
}

glm::vec3 meanEmission(const Scene& scene, size_t triangle) {
  const shared::Material& material = scene.materials[scene.triangleMaterials[triangle]];
  const bool textured = material.emissiveTexture != shared::kNoTexture;
  const bool masked = (material.flags & shared::kMaterialAlphaMask) != 0u;
  const bool maskTextured = masked && material.baseTexture != shared::kNoTexture;
  if (masked && !maskTextured && material.alpha < material.alphaCutoff) return glm::vec3(0.f);
  if (!textured && !maskTextured) return material.emission;

  const auto corner = [&](size_t k) -> const shared::Vertex& { return scene.vertices[scene.indices[triangle * 3 + k]]; };
  // As many points as texels are covered, in rows of equal sub-triangles.
  const auto texelsCovered = [&](const TextureImage& image, const glm::vec2& a, const glm::vec2& b) {
    return 0.5 * std::abs(static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x) * image.width * image.height;
  };
  double texels = 0;
  if (textured) {
    texels = texelsCovered(scene.textures[material.emissiveTexture], corner(1).uvEmissive - corner(0).uvEmissive,
                           corner(2).uvEmissive - corner(0).uvEmissive);
  }
  if (maskTextured) {
    texels = std::max(texels, texelsCovered(scene.textures[material.baseTexture], corner(1).uvBase - corner(0).uvBase,
                                            corner(2).uvBase - corner(0).uvBase));
  }
  const auto rows = static_cast<int>(std::clamp(std::ceil(std::sqrt(texels)), 1.0, 32.0));
  glm::dvec3 sum(0.0);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < 2 * (rows - j) - 1; ++i) {
      // Centroids: upright sub-triangles for even i, inverted ones for odd.
      const double shift = i % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
      const auto b = static_cast<float>((i / 2 + shift) / rows), c = static_cast<float>((j + shift) / rows);
      const auto at = [&](glm::vec2 shared::Vertex::*uv) { return corner(0).*uv * (1.f - b - c) + corner(1).*uv * b + corner(2).*uv * c; };
      if (maskTextured &&
          sampleTexture(scene.textures[material.baseTexture], at(&shared::Vertex::uvBase)).a * material.alpha < material.alphaCutoff)
        continue;
      sum +=
          textured ? glm::dvec3(sampleTexture(scene.textures[material.emissiveTexture], at(&shared::Vertex::uvEmissive))) : glm::dvec3(1.0);
    }
  }
  return material.emission * glm::vec3(sum / static_cast<double>(rows * rows));
}

}  // namespace radivox::scene
