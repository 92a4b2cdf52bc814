#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a pixel: the mean radiosity along its share of the block's directions. See modules/clustered_voxel/gather_pixels/gather_pixels.h.
#include "shared/dispatch.glsl"
#define RADIVOX_BIND_DISTANCE 8
#include "clustered_voxel/structure.glsl"
#include "clustered_voxel/plane_trace.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 9, scalar) readonly buffer RadiosityBuffer { vec3 faceRadiosity[]; };
layout(set = 0, binding = 10, scalar) readonly buffer DirectionBuffer { vec4 directions[]; };
layout(set = 0, binding = 11, rgba32f) writeonly uniform image2D rawImage;
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint rays;
};

// Tangents of n that turn smoothly with it (but at −z).
void frameOf(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float c = n.x * n.y * a;
  t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
  b = vec3(c, s + n.y * n.y * a, -n.y);
}

void main() {
  uint i = radivoxItemIndex();
  uvec2 blocks = (uvec2(width, height) + 3u) / 4u;
  uint blockCount = blocks.x * blocks.y;
  uint place = i / blockCount;
  if (place >= 16u) return;
  uint block = i % blockCount;
  uvec2 pixel = uvec2(block % blocks.x, block / blocks.x) * 4u + uvec2(place & 3u, place >> 2);
  if (pixel.x >= width || pixel.y >= height) return;
  vec4 position = imageLoad(positionImage, ivec2(pixel));
  vec4 sum = vec4(0.0);
  if (position.w != 0.0) {
    vec3 p = toGridSpace(grid, position.xyz);
    vec3 n = imageLoad(normalImage, ivec2(pixel)).xyz;
    vec3 t, b;
    frameOf(n, t, b);
    for (uint r = 0; r < rays; ++r) {
      vec3 local = directions[place * rays + r].xyz;
      vec3 d = t * local.x + b * local.y + n * local.z;
      float time;
      uint s = planeTrace(p, n, d, time);
      if (s == kNone) sum.w += 1.0;
      else sum.xyz += faceRadiosity[s];
    }
    sum /= float(rays);
  }
  imageStore(rawImage, ivec2(pixel), sum);
}
