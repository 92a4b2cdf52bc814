// Included by C++ and GLSL: the same struct text in both, scalar block layout.
#ifndef RADIVOX_SHADERS_SHARED_TYPES_H
#define RADIVOX_SHADERS_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace radivox::shared {
using uint = std::uint32_t;
using glm::ivec2;
using glm::ivec3;
using glm::ivec4;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
}  // namespace radivox::shared
#define RADIVOX_SHARED_BEGIN namespace radivox::shared {
#define RADIVOX_SHARED_END }
#define RADIVOX_CONST constexpr
#else
#extension GL_EXT_scalar_block_layout : require
#define RADIVOX_SHARED_BEGIN
#define RADIVOX_SHARED_END
#define RADIVOX_CONST const
#endif

#endif
