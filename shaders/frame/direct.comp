#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/light.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kFilter = 1u;        // texels; half width of the shadow filter
layout(constant_id = 1) const bool kShadowed = true;    // shadow maps are there
layout(constant_id = 3) const bool kMasked = false;     // some material has an alpha mask
layout(constant_id = 4) const bool kExactEdges = true;  // there are punctual lights, and their shadows end where triangles end, not texels
layout(constant_id = 5) const uint kSoleLight = 0xffffffffu;  // the kind of the one light; all ones: there may be more
// How emitters light: not at all; closed form × visible share of the samples; samples alone; closed form unshadowed; an image of others.
layout(constant_id = 2) const uint kEmitters = 0u;
const uint kEmittersNone = 0u, kEmittersShadowed = 1u, kEmittersSamples = 2u, kEmittersUnshadowed = 3u, kEmittersImage = 4u;
const bool kSampled = kEmitters == kEmittersShadowed || kEmitters == kEmittersSamples;

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 1, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 2, r32ui) readonly uniform uimage2D triangleImage;
layout(set = 0, binding = 3, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Info { SceneInfo info; };
layout(set = 0, binding = 6, scalar) readonly buffer Lights { Light lights[]; };
layout(set = 0, binding = 7, scalar) readonly buffer ShadowViews { ShadowView shadowViews[]; };
layout(set = 0, binding = 8, scalar) readonly buffer EmissiveTriangles { EmissiveTriangle emissiveTriangles[]; };
layout(set = 0, binding = 9) uniform sampler2DArray shadowDepth;
layout(set = 0, binding = 10) uniform usampler2DArray shadowTriangle;
layout(set = 0, binding = 11, rgba32f) readonly uniform image2D emittedImage;
layout(set = 0, binding = 12, rgba32f) writeonly uniform image2D irradianceImage;
layout(set = 0, binding = 13, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 14, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 15, scalar) readonly buffer View { Camera camera; };
layout(constant_id = 6) const bool kRays = false;             // shadows of punctual lights by rays through the triangles in the voxels
layout(constant_id = 7) const uint kSkip = 1u;                // shared/voxel_march.glsl
layout(constant_id = 8) const bool kCorners = false;          // triangleCorners is there
layout(constant_id = 9) const bool kSides = false;            // back faces of single-sided materials cast no shadow
#define RADIVOX_BIND_GRID 16
#define RADIVOX_BIND_OCCUPANCY 17
#define RADIVOX_BIND_RANK 18
#define RADIVOX_BIND_DISTANCE 19
#define RADIVOX_BIND_CLEARANCE 20
#define RADIVOX_SKIP kSkip
layout(set = 0, binding = 21) uniform usamplerBuffer triangleFirstTexels;
layout(set = 0, binding = 22) uniform usamplerBuffer triangleIdTexels;
layout(set = 0, binding = 23) uniform isamplerBuffer triangleCorners;
layout(set = 0, binding = 24, scalar) readonly buffer Textures { Texture textures[]; };

#include "frame/polygon.glsl"
#include "frame/shadow.glsl"

// Irradiance of all emissive triangles, unshadowed, and the sum of their form factors.
vec3 closedForm(vec3 p, vec3 n, vec3 g, out float formFactors) {
  vec3 sum = vec3(0.0);
  formFactors = 0.0;
  [[dont_unroll]] for (uint i = 0u; i < info.emissiveTriangleCount; ++i) {
    uint triangle = 3u * emissiveTriangles[i].triangle;
    vec3 a = vertices[indices[triangle]].position - p;
    vec3 b = vertices[indices[triangle + 1u]].position - p;
    vec3 c = vertices[indices[triangle + 2u]].position - p;
    float f = triangleFormFactor(a, b, c, n, g);
    sum += emissiveTriangles[i].emission * f;
    formFactors += f;
  }
  return sum * 3.14159265358979;
}

void main() {
  if (kRays) castBegin();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradianceImage)))) return;
  uint own = imageLoad(triangleImage, pixel).x;
  if (own == 0u) {
    imageStore(irradianceImage, pixel, vec4(0.0));
    return;
  }
  own -= 1u;
  vec4 position = imageLoad(positionImage, pixel);
  vec3 p = position.xyz;
  vec3 n = imageLoad(normalImage, pixel).xyz;
  vec3 p0 = vertices[indices[3u * own]].position;
  vec3 g = cross(vertices[indices[3u * own + 1u]].position - p0, vertices[indices[3u * own + 2u]].position - p0);
  float length2 = dot(g, g);
  g = length2 > 0.0 ? g * inversesqrt(length2) : n;
  if (dot(g, n) < 0.0) g = -g;  // the viewer's side, as n

  vec3 irradiance = vec3(0.0);
  vec3 sampled = vec3(0.0), sampledSeen = vec3(0.0);
  // Where the distance falls below the patch of emitter that a sample stands for, the sample no longer is a point: 1 / (d² + area / π), a disc's.
  float patchArea = info.emissiveArea / float(max(info.emitterSampleCount, 1u));
  const bool kSole = kSoleLight != 0xffffffffu;
  [[dont_unroll]] for (uint i = 0u; i < info.lightCount && !(kSole && i > 0u); ++i) {
    Light light = lights[i];
    if (kSole) light.type = kSoleLight;
    bool isSample = light.type == kLightEmitterSample;
    if (isSample && !kSampled) continue;
    vec3 unshadowed = lightIrradiance(light, p, n);
    if (!(max(unshadowed.x, max(unshadowed.y, unshadowed.z)) > 0.0)) continue;
    // Both normals must face the light: no light through the back of a surface whose shading normal leans over its edge.
    if (!(dot(g, light.type == kLightDirectional ? -light.direction : light.position - p) > 0.0)) continue;
    if (isSample) {
      vec3 d = light.position - p;
      float d2 = dot(d, d);
      unshadowed *= d2 / (d2 + patchArea / 3.14159265358979);
    }
    float seen = 1.0;
    if (kShadowed) {
      // Written so that specialization leaves out the way that no light of the scene takes.
      if (kRays && !(kSampled && isSample)) {
        seen = rayVisibility(light, p, g, own, position.w);
      } else if (kExactEdges && !(kSampled && isSample)) {
        seen = exactVisibility(light, p, g, own, position.w);
      } else {
        seen = filteredVisibility(light, p, g, own, isSample ? sqrt(patchArea) : 0.0);
      }
    }
    if (isSample) {
      sampled += unshadowed;
      sampledSeen += unshadowed * seen;
    } else {
      irradiance += unshadowed * seen;
    }
  }

  if (kEmitters == kEmittersShadowed) {
    // Ratio estimator: the closed form carries the energy, the samples only the visible share, so nothing is singular near an emitter.
    float formFactors;
    vec3 all = closedForm(p, n, g, formFactors);
    vec3 ratio = mix(vec3(1.0), sampledSeen / max(sampled, vec3(1e-30)), greaterThan(sampled, vec3(1e-30)));
    irradiance += all * ratio;
  } else if (kEmitters == kEmittersSamples) {
    irradiance += sampledSeen;
  } else if (kEmitters == kEmittersUnshadowed) {
    // Emitters that hide one another count once: a hemisphere has no more than form factor 1.
    float formFactors;
    vec3 all = closedForm(p, n, g, formFactors);
    irradiance += all / max(1.0, formFactors);
  } else if (kEmitters == kEmittersImage) {
    irradiance += imageLoad(emittedImage, pixel).xyz;
  }
  imageStore(irradianceImage, pixel, vec4(irradiance, 1.0));
}
