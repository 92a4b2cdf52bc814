#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Pass 0: 5×5 pixels with half weights at the rim, so that each of the 16 places of a block weighs the same: over a flat surface this is the mean
// over all of the block's directions. Later passes: 3×3 pixels, `step` pixels apart. All stop at edges of the surface; the later ones also where light
// differs by more than its noise, whose variance goes from pass to pass (as in Dammertz et al. 2010 and Schied et al. 2017, within one frame).
#include "shared/dispatch.glsl"
#define RADIVOX_BIND_GRID 0
#include "shared/voxel_lookup.glsl"
#include "clustered_voxel/gather_pixels/spread.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kSpread = false;   // there are later passes
layout(constant_id = 1) const bool kEvenSky = false;  // w, the share of rays that end in the sky, is light of its own: weighed by itself

layout(set = 0, binding = 1, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 2, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 3, rgba32f) readonly uniform image2D fromImage;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D toImage;
// Pass 0: mean squares of luminance. Then its variance, and with kEvenSky after it that of w.
layout(set = 0, binding = 5, scalar) readonly buffer SpreadFrom { float spreadFrom[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer SpreadTo { float spreadTo[]; };
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint pass;
  uint step_;
  uint rays;  // a pixel
};

// Light that differs by so many standard deviations still counts, by 1/e.
const float kDeviations = 4.0;  // of 1 to 6 the best or nearly so with 4, 8 and 12 rays in Sponza and two_rooms

const uint kStride = kEvenSky ? 2u : 1u;

// Of luminance and, with kEvenSky, of w.
vec2 varianceOf(uint pixel) {
  return vec2(spreadFrom[kStride * pixel], kEvenSky ? spreadFrom[kStride * pixel + 1u] : 0.0);
}

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  vec4 result = vec4(0.0);
  vec2 spread = vec2(0.0);
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    bool stops = kSpread && pass > 0u;
    vec4 own = imageLoad(fromImage, pixel);
    vec2 ownLight = vec2(luminanceOf(own.xyz), own.w);
    vec2 ownSpread = stops ? varianceOf(i) : vec2(0.0);
    vec2 total = vec2(0.0), squares = vec2(0.0);
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
        uint at = uint(q.y) * width + uint(q.x);
        vec2 weights = vec2(weight);
        if (stops) {
          vec2 lightSpread = varianceOf(at);
          vec2 change = vec2(luminanceOf(light.xyz), light.w) - ownLight;
          vec2 stop = exp(-change * change / max(kDeviations * kDeviations * (ownSpread + lightSpread), vec2(1e-37)));
          weights *= kEvenSky ? stop : stop.xx;
          spread += weights * weights * lightSpread;
        } else if (kSpread) {
          // A ray ends in the sky or does not: w is its own mean square.
          spread += weight * vec2(spreadFrom[at], light.w);
        }
        result += weights.xxxy * light;
        total += weights;
        squares += weights * weights;
      }
    if (total.x > 0.0 && total.y > 0.0) {
      result /= total.xxxy;
      // Pass 0: the variance of a mean over that many rays.
      vec2 mean = vec2(luminanceOf(result.xyz), result.w);
      spread = stops ? spread / (total * total) : max(spread / total - mean * mean, vec2(0.0)) * squares / (total * total * float(rays));
    } else {
      result = own;
      spread = ownSpread;
    }
  }
  imageStore(toImage, pixel, result);
  if (kSpread) spreadTo[kStride * i] = spread.x;
  if (kSpread && kEvenSky) spreadTo[kStride * i + 1u] = spread.y;
}
