// A colour for a number, the same in pictures (inspect) and in files (modules/vdb).
#ifndef RADIVOX_SHADERS_SHARED_ID_COLOUR_H
#define RADIVOX_SHADERS_SHARED_ID_COLOUR_H
#include "types.h"
RADIVOX_SHARED_BEGIN

#ifdef __cplusplus
inline
#endif
// Bright, linear, by a hash: neighbours in number are not neighbours in colour.
vec3 colourOfId(uint id) {
  uint h = id * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28) + 4u)) ^ h) * 277803737u;
  h = (h >> 22) ^ h;
  return 0.15f + 0.85f * vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0f;
}

RADIVOX_SHARED_END
#endif
