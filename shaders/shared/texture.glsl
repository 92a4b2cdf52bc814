// Reads the texture table. Texels lie in buffers behind device addresses, so that no descriptor counts limit the number of textures.
// engine/scene/texture.cpp does the same on the host. The includer declares
//   #extension GL_EXT_buffer_reference : require
//   #extension GL_EXT_buffer_reference_uvec2 : require
#ifndef RADIVOX_SHADERS_SHARED_TEXTURE_GLSL
#define RADIVOX_SHADERS_SHARED_TEXTURE_GLSL
#include "shared/scene.h"

layout(buffer_reference, buffer_reference_align = 4, scalar) readonly buffer TextureTexels { uint texels[]; };

// Column or row i of `size`, wherever i lies.
uint wrapTexel(int i, uint size, uint mode) {
  int n = int(size);
  if (mode == kWrapClamp) return uint(clamp(i, 0, n - 1));
  if (mode == kWrapMirror) {
    int period = 2 * n;
    int j = i - period * int(floor(float(i) / float(period)));
    j = j < 0 ? j + period : (j >= period ? j - period : j);  // the quotient was rounded
    return uint(j < n ? j : period - 1 - j);
  }
  int j = i - n * int(floor(float(i) / float(n)));
  return uint(j < 0 ? j + n : (j >= n ? j - n : j));
}

vec3 decodeSrgb(vec3 c) {
  return mix(pow((c + 0.055) * (1.0 / 1.055), vec3(2.4)), c * (1.0 / 12.92), vec3(lessThanEqual(c, vec3(0.04045))));
}

vec4 fetchTexel(Texture t, uint levelStart, uint width, uint height, int x, int y) {
  uint index = levelStart + wrapTexel(y, height, t.wrapV) * width + wrapTexel(x, width, t.wrapU);
  vec4 c = unpackUnorm4x8(TextureTexels(t.address).texels[index]);
  if ((t.flags & kTextureSrgb) != 0u) c.rgb = decodeSrgb(c.rgb);
  return c;
}

vec4 sampleTextureLevel(Texture t, vec2 uv, uint level) {
  uint start = 0u;
  uint width = t.width, height = t.height;
  for (uint l = 0u; l < level; ++l) {
    start += width * height;
    width = max(width >> 1, 1u);
    height = max(height >> 1, 1u);
  }
  vec2 at = uv * vec2(width, height);
  if ((t.flags & kTextureNearest) != 0u) return fetchTexel(t, start, width, height, int(floor(at.x)), int(floor(at.y)));
  at -= 0.5;
  vec2 low = floor(at);
  vec2 f = at - low;
  int x = int(low.x), y = int(low.y);
  vec4 top = mix(fetchTexel(t, start, width, height, x, y), fetchTexel(t, start, width, height, x + 1, y), f.x);
  vec4 bottom = mix(fetchTexel(t, start, width, height, x, y + 1), fetchTexel(t, start, width, height, x + 1, y + 1), f.x);
  return mix(top, bottom, f.y);
}

// Bilinear within levels (unless nearest), linear between them. rgb is linear light; level 0 is the finest.
vec4 sampleTexture(Texture t, vec2 uv, float level) {
  float clamped = clamp(level, 0.0, float(t.levelCount - 1u));
  uint fine = uint(clamped);
  vec4 c = sampleTextureLevel(t, uv, fine);
  float f = clamped - float(fine);
  return f > 0.0 ? mix(c, sampleTextureLevel(t, uv, fine + 1u), f) : c;
}

// Level at which a texel is about as large as a pixel, from the change of uv across it.
float textureLevel(Texture t, vec2 uvDx, vec2 uvDy) {
  vec2 size = vec2(t.width, t.height);
  vec2 dx = uvDx * size, dy = uvDy * size;
  return 0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1e-12));
}

#endif
