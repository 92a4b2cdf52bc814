#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/scene.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kHasDirect = true;
layout(constant_id = 1) const bool kHasIndirect = true;    // the indirect image is there
layout(constant_id = 2) const bool kWantsIndirect = true;  // false: 0 bounces, only its alpha (sky visibility) counts
layout(constant_id = 3) const bool kWriteDirect = false;
layout(constant_id = 4) const bool kWriteIndirect = false;
layout(constant_id = 5) const bool kWriteIrradiance = false;

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D albedoImage;
layout(set = 0, binding = 1, rgba32f) readonly uniform image2D emissionImage;
layout(set = 0, binding = 2, rgba32f) readonly uniform image2D irradianceImage;
layout(set = 0, binding = 3, rgba32f) readonly uniform image2D indirectImage;
layout(set = 0, binding = 4, scalar) readonly buffer Info { SceneInfo info; };
layout(set = 0, binding = 5, rgba32f) writeonly uniform image2D colorImage;
layout(set = 0, binding = 6, rgba32f) writeonly uniform image2D directImage;
layout(set = 0, binding = 7, rgba32f) writeonly uniform image2D indirectRadianceImage;
layout(set = 0, binding = 8, rgba32f) writeonly uniform image2D irradianceDirectImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(colorImage)))) return;
  vec4 albedo = imageLoad(albedoImage, pixel);
  bool sky = albedo.a == 0.0;
  vec3 direct = vec3(0.0), indirect = vec3(0.0), color = info.skyRadiance, reflectance = vec3(0.0);
  if (!sky) {
    reflectance = albedo.rgb / 3.14159265358979;
    if (kHasDirect) direct = imageLoad(irradianceImage, pixel).rgb;
    if (kHasIndirect) {
      vec4 arriving = imageLoad(indirectImage, pixel);
      direct += 3.14159265358979 * arriving.a * info.skyRadiance;
      if (kWantsIndirect) indirect = arriving.rgb;
    }
    color = reflectance * (direct + indirect) + imageLoad(emissionImage, pixel).rgb;
  }
  imageStore(colorImage, pixel, vec4(color, sky ? 0.0 : 1.0));
  if (kWriteDirect) imageStore(directImage, pixel, vec4(reflectance * direct, 1.0));
  if (kWriteIndirect) imageStore(indirectRadianceImage, pixel, vec4(reflectance * indirect, 1.0));
  if (kWriteIrradiance) imageStore(irradianceDirectImage, pixel, vec4(direct, 1.0));
}
