// Private to engine/gpu: the little that bind() must know of a shader.
#pragma once

#include <span>
#include <vector>

#include "engine/gpu/pipeline.h"

namespace radivox::gpu {

/// Sets kinds[b] for every image at set 0, binding b of the SPIR-V; other entries stay.
void reflectImageKinds(std::span<const uint32_t> words, std::vector<ImageKind>& kinds);

}  // namespace radivox::gpu
