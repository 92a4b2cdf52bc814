#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Colours voxel faces by what they are or hold: faces.glsl's pixels in, sRGB-encoded RGBA8 words out.
#include "shared/dispatch.glsl"
#include "shared/voxel_codec.h"
#include "viewer/faces.glsl"
#include "viewer/overlay.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer Pixels { uvec2 pixels[]; };
layout(set = 0, binding = 1, rgba8) readonly uniform image2D pictureImage;
layout(set = 0, binding = 2, scalar) readonly buffer Faces { Face faces[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Places { ClusterPlace places[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Values { float values[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Valid { uint valid[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Marks { float marks[]; };
layout(set = 0, binding = 8, scalar) writeonly buffer Out { uint texels[]; };
layout(push_constant, scalar) uniform Push { PaintPush push; };

const vec3 kNothing = vec3(0.02, 0.02, 0.03);  // background
const vec3 kUnknown = vec3(0.10, 0.04, 0.12);  // a face that was not asked for: no value
const vec3 kPointed = vec3(0.1, 1.0, 1.0);

vec3 colourOf(uint id) {
  uint h = id * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28) + 4u)) ^ h) * 277803737u;
  h = (h >> 22) ^ h;
  return 0.15 + 0.85 * vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

// Black, violet, red, orange, pale yellow.
vec3 heatOf(float x) {
  x = clamp(x, 0.0, 1.0);
  return clamp(vec3(2.2 * x, 2.4 * x * x - 0.4 * x, 0.6 * sin(3.1 * x) + 3.0 * max(x - 0.75, 0.0)), 0.0, 1.0);
}

vec3 encodeSrgb(vec3 x) {
  return mix(1.055 * pow(max(x, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

// Encoded.
vec3 colourOfFace(uint s, vec3 picture) {
  if (push.mode == kPaintAlbedo) return encodeSrgb(decodeAlbedo(faces[s].albedo));
  if (push.mode == kPaintClusters) return colourOf(labels[s]);
  if (push.mode == kPaintClusterNormals) return 0.5 + 0.5 * places[labels[s]].normal;
  if (push.mode == kPaintValues) {
    if (push.usesValid != 0u && (valid[s >> 5] >> (s & 31u) & 1u) == 0u) return kUnknown;
    uint at = s * push.valueStride;
    return encodeSrgb(clamp(vec3(values[at], values[at + 1u], values[at + 2u]) * push.scale, 0.0, 1.0));
  }
  float mark = max(marks[labels[s]], marks[push.clusterCount + s]);
  return mark > 0.0 ? heatOf(0.3 + 0.7 * mark * push.markScale) : picture;
}

void main() {
  uint i = radivoxItemIndex();
  if (i >= push.width * push.height) return;
  uvec2 pixel = pixels[i];
  vec3 picture = vec3(0.0);
  if (push.hasPicture != 0u) {
    picture = imageLoad(pictureImage, ivec2(i % push.width, i / push.width)).rgb;
    if (push.mode == kPaintMarks) picture = vec3(0.6 * dot(picture, vec3(0.2126, 0.7152, 0.0722)));
  }
  vec3 colour = push.hasPicture != 0u && push.mode == kPaintMarks ? picture : kNothing;
  float shade = uintBitsToFloat(pixel.y);
  if (pixel.x == kSolid) {
    colour = vec3(0.2) * shade;
  } else if (pixel.x != 0u) {
    if (push.hasPicture == 0u && push.mode == kPaintMarks) picture = 0.35 * encodeSrgb(decodeAlbedo(faces[pixel.x - 1u].albedo));
    colour = colourOfFace(pixel.x - 1u, picture) * shade;
    if (pixel.x == push.pointedFace) colour = kPointed;
  }
  texels[i] = packUnorm4x8(vec4(colour, 1.0));
}
