#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Pass 0: 5×5 pixels with half weights at the rim, so that each of the 16 places of a block weighs the same: over a flat surface this is the mean
// over all of the block's directions. Later passes: 3×3 pixels, `step` pixels apart. All stop at edges of the surface; the later ones also where light
// differs by more than its noise, whose variance goes from pass to pass (as in Dammertz et al. 2010 and Schied et al. 2017, within one frame).
#include "shared/dispatch.glsl"
#include "shared/scene.h"
#define RADIVOX_BIND_GRID 0
#include "shared/voxel_lookup.glsl"
#include "clustered_voxel/gather_pixels/spread.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kSpread = false;   // there are later passes
layout(constant_id = 1) const bool kEvenSky = false;  // w is the share of rays that end in a sky of one radiance
layout(constant_id = 2) const bool kLight = true;     // xyz counts; else it is not asked for, and w alone tells noise

layout(set = 0, binding = 1, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 2, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 3, rgba32f) readonly uniform image2D fromImage;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D toImage;
layout(set = 0, binding = 5, scalar) readonly buffer SpreadFrom { float spreadFrom[]; };  // pass 0: mean squares; then variances; of luminance
layout(set = 0, binding = 6, scalar) writeonly buffer SpreadTo { float spreadTo[]; };     // variances
layout(set = 0, binding = 7, scalar) readonly buffer Info { SceneInfo info; };
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint pass;
  uint step_;
  uint rays;  // a pixel
};

// Light that differs by so many standard deviations still counts, by 1/e.
const float kDeviations = 4.0;  // of 1 to 6 the best or nearly so with 4, 8 and 12 rays in Sponza and two_rooms

float luminanceAt(vec4 light) {
  return luminanceOf((kLight ? light.xyz : vec3(0.0)) + (kEvenSky ? 3.14159265358979 * light.w * info.skyRadiance : vec3(0.0)));
}

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  vec4 result = vec4(0.0);
  float spread = 0.0;
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    bool stops = kSpread && pass > 0u;
    vec4 own = imageLoad(fromImage, pixel);
    float ownLuminance = luminanceAt(own), ownSpread = stops ? spreadFrom[i] : 0.0;
    float total = 0.0, squares = 0.0;
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
        vec4 light = imageLoad(fromImage, q);
        float lightSpread = kSpread ? spreadFrom[uint(q.y) * width + uint(q.x)] : 0.0;
        if (stops) {
          float change = luminanceAt(light) - ownLuminance;
          weight *= exp(-change * change / max(kDeviations * kDeviations * (ownSpread + lightSpread), 1e-30));
        }
        result += weight * light;
        spread += (stops ? weight : 1.0) * weight * lightSpread;
        total += weight;
        squares += weight * weight;
      }
    if (total > 0.0) {
      result /= total;
      // Pass 0: the variance of a mean over that many rays.
      float mean = luminanceAt(result);
      spread = stops ? spread / (total * total) : max(spread / total - mean * mean, 0.0) * squares / (total * total * float(rays));
    } else {
      result = own;
      spread = ownSpread;
    }
  }
  imageStore(toImage, pixel, result);
  if (kSpread) spreadTo[i] = spread;
}
