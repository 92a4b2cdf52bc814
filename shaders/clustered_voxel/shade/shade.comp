#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a pixel: E(x, n) = Σ_k n_k² E_k, each E_k a weighted mean over the faces of direction sign(n_k) e_k about x.
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kInterpolation = 0;  // Shade::Interpolation
layout(constant_id = 1) const bool kError = false;      // the standard error is wanted

layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 8, scalar) readonly buffer FilteredBuffer { vec4 filtered[]; };
layout(set = 0, binding = 9, scalar) readonly buffer ValidBuffer { uint valid[]; };
layout(set = 0, binding = 10, rgba32f) writeonly uniform image2D irradianceImage;
layout(set = 0, binding = 11, scalar) readonly buffer ErrorBuffer { vec3 standardError[]; };
layout(set = 0, binding = 12, rgba32f) writeonly uniform image2D errorImage;
layout(constant_id = 2) const bool kSky = false;  // the sky has an image
layout(set = 0, binding = 13, scalar) readonly buffer FilteredSkyBuffer { vec4 filteredSky[]; };
layout(set = 0, binding = 14, rgba32f) writeonly uniform image2D skyImage;
layout(constant_id = 3) const bool kEmitted = false;  // emitters light by rays
layout(set = 0, binding = 15, scalar) readonly buffer FilteredEmittedBuffer { vec4 filteredEmitted[]; };
layout(set = 0, binding = 16, rgba32f) writeonly uniform image2D emittedImage;
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
};

vec4 sums[4];  // per axis; the fourth is the fallback of visitReceivers
vec3 errors[4];
vec3 skies[4];
vec3 emissions[4];
float totals[4];
void take(uint s, float weight, uint k) {
  if ((valid[s >> 5] & (1u << (s & 31u))) == 0u) return;
  sums[k] += weight * filtered[s];
  // Faces about one point see much the same: their errors add up in the worst case.
  if (kError) errors[k] += weight * standardError[s];
  if (kSky) skies[k] += weight * filteredSky[s].xyz;
  if (kEmitted) emissions[k] += weight * filteredEmitted[s].xyz;
  totals[k] += weight;
}
#define RECEIVER_VISIT(face, weight, k) take(face, weight, k);
#include "clustered_voxel/receiver.glsl"

void main() {
  uint i = radivoxItemIndex();
  if (i >= width * height) return;
  ivec2 pixel = ivec2(i % width, i / width);
  vec4 position = imageLoad(positionImage, pixel);
  vec4 result = vec4(0.0);
  vec3 error = vec3(0.0);
  vec3 sky = vec3(0.0);
  vec3 emitted = vec3(0.0);
  if (position.w != 0.0) {
    vec3 n = imageLoad(normalImage, pixel).xyz;
    for (uint k = 0; k < 4; ++k) {
      sums[k] = vec4(0.0);
      errors[k] = vec3(0.0);
      skies[k] = vec3(0.0);
      emissions[k] = vec3(0.0);
      totals[k] = 0.0;
    }
    visitReceivers(toGridSpace(grid, position.xyz), n, kInterpolation == 0);
    float mixed = 0.0;
    for (uint k = 0; k < 3; ++k)
      if (totals[k] > 0.0) {
        result += n[k] * n[k] * sums[k] / totals[k];
        if (kError) error += n[k] * n[k] * errors[k] / totals[k];
        if (kSky) sky += n[k] * n[k] * skies[k] / totals[k];
        if (kEmitted) emitted += n[k] * n[k] * emissions[k] / totals[k];
        mixed += n[k] * n[k];
      }
    if (mixed > 0.0) {
      result /= mixed;
      error /= mixed;
      sky /= mixed;
      emitted /= mixed;
    } else if (totals[3] > 0.0) {
      result = sums[3] / totals[3];
      error = errors[3] / totals[3];
      sky = skies[3] / totals[3];
      emitted = emissions[3] / totals[3];
    }
  }
  imageStore(irradianceImage, pixel, result);
  if (kSky) imageStore(skyImage, pixel, vec4(sky, 0.0));
  if (kEmitted) imageStore(emittedImage, pixel, vec4(emitted, 0.0));
  if (kError) imageStore(errorImage, pixel, vec4(error, 0.0));
}
