// The table that the build writes: SPIR-V by the shader's path under shaders/.
#pragma once

#include <cstddef>
#include <cstdint>

namespace radivox::gpu {

struct EmbeddedShader {
  const char* name;
  const uint32_t* words;
  size_t wordCount;
};
const EmbeddedShader* embeddedShaders();
size_t embeddedShaderCount();

}  // namespace radivox::gpu
