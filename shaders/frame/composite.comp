#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/scene.h"
#include "shared/sky.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kHasDirect = true;
layout(constant_id = 1) const bool kHasIndirect = true;    // the indirect image is there
layout(constant_id = 2) const bool kWantsIndirect = true;  // false: 0 bounces, only its alpha (sky visibility) counts
layout(constant_id = 3) const bool kWriteDirect = false;
layout(constant_id = 4) const bool kWriteIndirect = false;
layout(constant_id = 5) const bool kWriteIrradiance = false;
layout(constant_id = 6) const bool kHasSky = false;    // E_sky has an image of its own
layout(constant_id = 7) const bool kSkyImage = false;  // the sky itself is an image

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D albedoImage;
layout(set = 0, binding = 1, rgba32f) readonly uniform image2D emissionImage;
layout(set = 0, binding = 2, rgba32f) readonly uniform image2D irradianceImage;
layout(set = 0, binding = 3, rgba32f) readonly uniform image2D indirectImage;
layout(set = 0, binding = 4, scalar) readonly buffer Info { SceneInfo info; };
layout(set = 0, binding = 5, rgba32f) writeonly uniform image2D colorImage;
layout(set = 0, binding = 6, rgba32f) writeonly uniform image2D directImage;
layout(set = 0, binding = 7, rgba32f) writeonly uniform image2D indirectRadianceImage;
layout(set = 0, binding = 8, rgba32f) writeonly uniform image2D irradianceDirectImage;

layout(set = 0, binding = 9, rgba32f) readonly uniform image2D skyIrradianceImage;
layout(set = 0, binding = 10, scalar) readonly buffer SkyBuffer { vec3 sky[]; };
layout(set = 0, binding = 11, scalar) readonly buffer CameraBuffer { Camera camera; };

vec3 skyTexel(ivec2 at) {
  at = ivec2((at.x + int(info.skyWidth)) % int(info.skyWidth), clamp(at.y, 0, int(info.skyHeight) - 1));
  return sky[kSkyFirstTexel + uint(at.y) * info.skyWidth + uint(at.x)];
}

vec3 background(ivec2 pixel) {
  vec3 radiance = info.skyRadiance;
  if (!kSkyImage) return radiance;
  vec3 d = camera.forward;
  if (camera.orthographic == 0u) {
    vec2 ndc = (vec2(pixel) + 0.5) / vec2(camera.width, camera.height) * 2.0 - 1.0;
    d = normalize((camera.inverseViewProjection * vec4(ndc, 0.0, 1.0)).xyz);
  }
  vec2 place = skyPlace(d, info.skyTurn) * vec2(info.skyWidth, info.skyHeight) - 0.5;
  ivec2 corner = ivec2(floor(place));
  vec2 share = place - vec2(corner);
  vec3 top = mix(skyTexel(corner), skyTexel(corner + ivec2(1, 0)), share.x);
  vec3 bottom = mix(skyTexel(corner + ivec2(0, 1)), skyTexel(corner + ivec2(1, 1)), share.x);
  return radiance + mix(top, bottom, share.y);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(colorImage)))) return;
  vec4 albedo = imageLoad(albedoImage, pixel);
  bool isSky = albedo.a == 0.0;
  vec3 direct = vec3(0.0), indirect = vec3(0.0), color = vec3(0.0), reflectance = vec3(0.0);
  if (isSky) {
    color = background(pixel);
  } else {
    reflectance = albedo.rgb / 3.14159265358979;
    if (kHasDirect) direct = imageLoad(irradianceImage, pixel).rgb;
    if (kHasIndirect) {
      vec4 arriving = imageLoad(indirectImage, pixel);
      if (!kHasSky) direct += 3.14159265358979 * arriving.a * info.skyRadiance;
      if (kWantsIndirect) indirect = arriving.rgb;
    }
    if (kHasSky) direct += imageLoad(skyIrradianceImage, pixel).rgb;
    color = reflectance * (direct + indirect) + imageLoad(emissionImage, pixel).rgb;
  }
  imageStore(colorImage, pixel, vec4(color, isSky ? 0.0 : 1.0));
  if (kWriteDirect) imageStore(directImage, pixel, vec4(reflectance * direct, 1.0));
  if (kWriteIndirect) imageStore(indirectRadianceImage, pixel, vec4(reflectance * indirect, 1.0));
  if (kWriteIrradiance) imageStore(irradianceDirectImage, pixel, vec4(direct, 1.0));
}
