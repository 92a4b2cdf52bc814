// Rays and flux of shadow-map texels, and unshadowed irradiance of punctual lights (KHR_lights_punctual; METHODS section 0).
#ifndef RADIVOX_SHADERS_SHARED_LIGHT_GLSL
#define RADIVOX_SHADERS_SHARED_LIGHT_GLSL
#include "shared/scene.h"

// The ray through a point of a shadow view, from the light; `ndc` in [−1, 1]². d is unit.
void shadowRay(ShadowView view, Light light, vec2 ndc, out vec3 origin, out vec3 d) {
  if (light.type == kLightDirectional) {
    vec4 near = view.inverseViewProjection * vec4(ndc, 1.0, 1.0);
    origin = near.xyz / near.w;
    d = light.direction;
  } else {
    origin = view.origin;
    d = normalize((view.inverseViewProjection * vec4(ndc, 0.0, 1.0)).xyz);  // depth 0 is infinity
  }
}

// Angular attenuation of a spot light, as the extension recommends.
float spotAttenuation(Light light, vec3 d) {
  float scale = 1.0 / max(0.001, light.cosInner - light.cosOuter);
  float a = clamp((dot(light.direction, d) - light.cosOuter) * scale, 0.0, 1.0);
  return a * a;
}

// Range window of a point or spot light, as the extension recommends.
float rangeWindow(Light light, float distance) {
  if (light.range <= 0.0) return 1.0;
  float r = distance / light.range;
  return clamp(1.0 - r * r * r * r, 0.0, 1.0);
}

// Radiant intensity towards unit direction d, W/sr (not for directional lights).
vec3 lightIntensity(Light light, vec3 d) {
  if (light.type == kLightSpot) return light.intensity * spotAttenuation(light, d);
  if (light.type == kLightEmitterSample) return light.intensity * max(0.0, dot(light.direction, d));
  return light.intensity;
}

// Flux through a texel whose centre's ray has direction d and lands at p, W.
vec3 shadowTexelFlux(ShadowView view, Light light, vec3 d, vec3 p) {
  if (light.type == kLightDirectional) return light.intensity * view.texelFlux;
  // The texel is a patch of area texelFlux on the plane at distance 1 along the view's axis: dω = area · cos³.
  vec3 axis = normalize((view.inverseViewProjection * vec4(0.0, 0.0, 0.0, 1.0)).xyz);
  float c = dot(axis, d);
  return lightIntensity(light, d) * (view.texelFlux * c * c * c * rangeWindow(light, distance(p, view.origin)));
}

// Irradiance at p on a plane facing along n, unshadowed, W/m².
vec3 lightIrradiance(Light light, vec3 p, vec3 n) {
  if (light.type == kLightDirectional) return light.intensity * max(0.0, -dot(n, light.direction));
  vec3 toP = p - light.position;
  float r2 = dot(toP, toP);
  if (!(r2 > 0.0)) return vec3(0.0);
  float r = sqrt(r2);
  vec3 d = toP / r;
  return lightIntensity(light, d) * (max(0.0, -dot(n, d)) * rangeWindow(light, r) / r2);
}

#endif
