// One frame of a window as plain data: what Dear ImGui drew, and the pictures among it. Any thread may hold and paint it.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "engine/gpu/device.h"
#include "samples/viewer/picture.h"
#include "shaders/viewer/panels.h"

namespace radivox::viewer {

/// Textures by number, as ImTextureID holds them.
constexpr size_t kFontTexture = 0, kPictureTexture = 1, kTruthTexture = 2, kTextureCount = 3;

struct PanelFrame {
  uint32_t width = 0, height = 0;
  std::vector<shared::PanelVertex> vertices;
  std::vector<uint32_t> indices;
  struct Draw {
    VkRect2D clip{};
    size_t texture = kFontTexture;
    uint32_t firstIndex = 0, indexCount = 0, firstVertex = 0;
  };
  std::vector<Draw> draws;
  std::array<std::shared_ptr<const Pixels>, kTextureCount> textures;  ///< null: nothing is drawn with it
};

}  // namespace radivox::viewer
