#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Pass 0: 5×5 pixels with half weights at the rim, so that each of the 16 places of a block weighs the same: over a flat surface this is the mean
// over all of the block's directions. Later passes: the same kernel with holes, `step` pixels apart. All stop at edges of the surface.
#include "shared/dispatch.glsl"
#define RADIVOX_BIND_GRID 0
#include "shared/voxel_lookup.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 1, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 2, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 3, rgba32f) readonly uniform image2D fromImage;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D toImage;
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint pass;
  uint step_;
};

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  vec4 result = vec4(0.0);
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    float total = 0.0;
    int reach = pass == 0u ? 2 : 1;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        ivec2 q = pixel + ivec2(dx, dy) * int(step_);
        if (any(lessThan(q, ivec2(0))) || q.x >= int(width) || q.y >= int(height)) continue;
        vec4 there = imageLoad(positionImage, q);
        if (there.w == 0.0) continue;
        vec3 offset = (there.xyz - position.xyz) * grid.inverseH;
        float agree = max(0.0, dot(imageLoad(normalImage, q).xyz, n) * 8.0 - 7.0);
        // On the same sheet, and no farther than a few voxels along it: what lies behind an edge of the view is another place.
        float offPlane = dot(offset, n) * 4.0;
        float along2 = dot(offset, offset);
        float weight = agree * max(0.0, 1.0 - offPlane * offPlane) * exp(-0.5 * along2);
        if (pass == 0u) weight *= (abs(dx) == 2 ? 0.5 : 1.0) * (abs(dy) == 2 ? 0.5 : 1.0);
        else weight *= (dx == 0 ? 2.0 : 1.0) * (dy == 0 ? 2.0 : 1.0);
        result += weight * imageLoad(fromImage, q);
        total += weight;
      }
    result = total > 0.0 ? result / total : imageLoad(fromImage, pixel);
  }
  imageStore(toImage, pixel, result);
}
