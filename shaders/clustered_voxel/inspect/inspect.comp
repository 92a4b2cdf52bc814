#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The voxel face that a pixel's surface belongs to: in its own voxel, of the direction nearest to its normal that is there.
#include "shared/dispatch.glsl"
#include "shared/id_colour.h"
#include "clustered_voxel/structure.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kWhat = 0;  // 0: face, 1: cluster

layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 8, scalar) readonly buffer LabelBuffer { uint labels[]; };
layout(set = 0, binding = 9, rgba32f) writeonly uniform image2D outImage;
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
};

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  vec4 result = vec4(0.0);
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    uint voxel = voxelIndex(ivec3(floor(toGridSpace(grid, position.xyz))));
    uint best = kNone;
    float most = -2.0;
    if (voxel != kNone)
      for (uint f = 0; f < kFaceCount; ++f) {
        uint s = faceIndex(voxel, f);
        if (s == kNone || dot(faceVector(f), n) <= most) continue;
        most = dot(faceVector(f), n);
        best = s;
      }
    if (best != kNone)
      result = kWhat == 0 ? vec4(float(best) + 1.0, float(voxel), float(faceAt(best).key & 7u), faceAt(best).area)
                          : vec4(colourOfId(labels[best]), float(labels[best]) + 1.0);
  }
  imageStore(outImage, pixel, result);
}
