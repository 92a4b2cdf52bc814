#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The voxel face that each pixel's surface belongs to: in its own voxel, of the direction nearest to its normal that is there.
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"
#include "viewer/faces.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 8, scalar) writeonly buffer Pixels { uvec2 pixels[]; };
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  float pixelAngle;
};

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  uint best = kNone;
  bool occupied = false;
  float shade = 1.0;
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    vec3 p = toGridSpace(grid, position.xyz);
    uint voxel = voxelIndex(ivec3(floor(p)));
    occupied = voxel != kNone;
    float most = -2.0;
    uint axis = 0u;
    for (uint f = 0; occupied && f < kFaceCount; ++f) {
      uint s = faceIndex(voxel, f);
      if (s == kNone || dot(faceVector(f), n) <= most) continue;
      most = dot(faceVector(f), n);
      best = s;
      axis = f >> 1;
    }
    shade = edgeShade(fract(p), axis, position.w * pixelAngle * grid.inverseH);
  }
  pixels[i] = uvec2(best != kNone ? best + 1u : (occupied ? kSolid : 0u), floatBitsToUint(shade));
}
