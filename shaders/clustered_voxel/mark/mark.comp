#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a pixel: sets the bit of every face in its stencil.
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 8, scalar) buffer ShownBuffer { uint shown[]; };
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
};

// Most pixels of a face find its bit set already: a read is cheaper than an atomic.
void mark(uint s) {
  uint bit = 1u << (s & 31u);
  if ((shown[s >> 5] & bit) == 0u) atomicOr(shown[s >> 5], bit);
}
#define RECEIVER_VISIT(face, weight, k) mark(face);
#include "clustered_voxel/receiver.glsl"

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  if (position.w == 0.0) return;
  vec3 p = toGridSpace(grid, position.xyz);
  // Both interpolations read within this stencil's reach.
  visitReceivers(p, imageLoad(normalImage, pixel).xyz, true);
  visitReceivers(p, imageLoad(normalImage, pixel).xyz, false);
}
