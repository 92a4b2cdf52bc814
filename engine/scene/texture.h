// Textures on the host: mip levels for upload, and the same lookup that shaders/shared/texture.glsl does.
#pragma once

#include "engine/scene/scene.h"

namespace radivox::scene {

/// All levels, finest first, RGBA with red in the low byte. Each halves the one before (rounded down), filtered in linear light with exact
/// box weights, so that means are kept for any size.
struct MipChain {
  std::vector<uint32_t> texels;
  uint32_t levelCount = 0;
};
MipChain buildMipChain(const TextureImage& image);

/// Level 0 at uv; rgb is linear light.
glm::vec4 sampleTexture(const TextureImage& image, const glm::vec2& uv);

/// Mean L_e over a triangle: emissive texture and alpha mask included.
glm::vec3 meanEmission(const Scene& scene, size_t triangle);

}  // namespace radivox::scene
