// What the panels' shaders and their host side agree on.
#ifndef RADIVOX_SHADERS_VIEWER_PANELS_H
#define RADIVOX_SHADERS_VIEWER_PANELS_H
#include "../shared/types.h"
RADIVOX_SHARED_BEGIN

struct PanelVertex {
  vec2 position;  // pixels
  vec2 uv;
  uint colour;  // RGBA8, sRGB-encoded
};

struct PanelPush {
  float width;  // of the window, pixels
  float height;
  uint firstIndex;
  uint firstVertex;
  uint textureWidth;
  uint textureHeight;
};

RADIVOX_SHARED_END
#endif
