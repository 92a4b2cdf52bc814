#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
// One lane a pixel: the mean radiosity along its share of the block's directions, so many rays a dispatch, which goes on from the sums of the one
// before. See modules/clustered_voxel/gather_pixels/gather_pixels.h.
#include "shared/dispatch.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSkip = 2;
layout(constant_id = 1) const bool kNear = false;    // the first voxels of a ray are tested by their triangles
layout(constant_id = 2) const bool kMasked = false;  // some material has an alpha mask
layout(constant_id = 3) const bool kShadow = false;  // hits on near triangles look their direct light up

#define RADIVOX_BIND_DISTANCE 8
#define RADIVOX_BIND_CAST_FIRST 4
#define RADIVOX_BIND_PLANES 12
#define RADIVOX_BIND_PLANE_EXTRAS 13
#define RADIVOX_BIND_CLEARANCE 14
#define RADIVOX_SKIP kSkip
#define RADIVOX_HIT 0
#define RADIVOX_VOXEL_COUNT voxelCount
layout(set = 0, binding = 6, rgba32f) readonly uniform image2D positionImage;
layout(set = 0, binding = 7, rgba32f) readonly uniform image2D normalImage;
layout(set = 0, binding = 9, scalar) readonly buffer RadiosityBuffer { vec3 faceRadiosity[]; };
layout(set = 0, binding = 10, scalar) readonly buffer DirectionBuffer { vec2 directions[]; };  // of the unit square
layout(set = 0, binding = 11, rgba32f) uniform image2D rawImage;
#include "shared/scene.h"
layout(set = 0, binding = 15, r32ui) readonly uniform uimage2D triangleImage;
layout(set = 0, binding = 16) uniform usamplerBuffer triangleFirstTexels;
layout(set = 0, binding = 17) uniform usamplerBuffer triangleIdTexels;
layout(set = 0, binding = 18, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 19, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 20, scalar) readonly buffer TriangleMaterials { uint triangleMaterials[]; };
layout(set = 0, binding = 21, scalar) readonly buffer Materials { Material materials[]; };
layout(set = 0, binding = 22, scalar) readonly buffer Textures { Texture textures[]; };
layout(set = 0, binding = 23, scalar) readonly buffer Lights { Light lights[]; };
layout(set = 0, binding = 24, scalar) readonly buffer ShadowViews { ShadowView shadowViews[]; };
layout(set = 0, binding = 25) uniform sampler2DArray shadowDepth;
layout(set = 0, binding = 26) uniform usampler2DArray shadowTriangle;
layout(set = 0, binding = 27, scalar) readonly buffer FaceIrradiance { vec3 faceIrradiance[]; };
layout(constant_id = 4) const bool kCorners = false;  // triangleCorners is there
layout(set = 0, binding = 28) uniform isamplerBuffer triangleCorners;
layout(constant_id = 5) const bool kSky = false;  // faceIrradiance holds the sky's light, which no shadow map tells
layout(set = 0, binding = 29, scalar) readonly buffer SkyIrradiance { vec3 skyIrradiance[]; };
layout(constant_id = 6) const bool kSkyImage = false;
// By address: there are 32 bindings at most.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SkyValues { vec3 values[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer InfoAt { SceneInfo info; };
layout(set = 0, binding = 31, rgba32f) uniform image2D rawSkyImage;
layout(constant_id = 7) const bool kEmitted = false;  // emitters light through these rays, and no other way
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Emission { vec3 of[]; };
layout(set = 0, binding = 30, rgba32f) uniform image2D rawEmittedImage;
layout(constant_id = 8) const bool kSpread = false;   // the filter asks how much the rays of a pixel differ
const uint kTraceAndLight = 0u;
const uint kTraceOnly = 1u;  // what rays hit is kept
const uint kLightOnly = 2u;  // rays hit what they hit when last traced
layout(constant_id = 9) const uint kWork = kTraceAndLight;
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Hits { uvec2 of[]; };  // face, triangle: a plane of pixels a ray
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Squares { float of[]; };
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint rays;
  uint firstRay;       // of this dispatch
  uint endRay;
  uint voxelCount;
  float nearDistance;  // voxels
  uint lightCount;
  uvec2 sky;           // address of scene.sky
  uvec2 skyInfo;       // of scene.info
  uvec2 emission;      // of B_e of each face
  uvec2 squares;       // of the mean squares of what each pixel's rays bring (luminance): light from surfaces,
  uvec2 skySquares;    // the sky image's light,
  uvec2 emittedSquares;  // emitters'
  uvec2 hits;
};
#include "clustered_voxel/structure.glsl"
#include "shared/voxel_walk.glsl"
#include "shared/light.glsl"
#include "shared/shadow_lookup.glsl"
#include "shared/sky.h"
#include "clustered_voxel/gather_pixels/spread.glsl"

// Direct irradiance at a point of a triangle, as one texel of each shadow map has it. n: unit, on the side that is looked at.
vec3 directIrradiance(vec3 p, vec3 n, uint triangle) {
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < lightCount; ++i) {
    vec3 unshadowed = lightIrradiance(lights[i], p, n);
    if (!(max(unshadowed.x, max(unshadowed.y, unshadowed.z)) > 0.0)) continue;
    Lookup l;
    uint state = kLit, id;
    vec3 occluder;
    if (prepareLookup(lights[i], p, l)) state = classifyTexel(l, ivec2(floor(l.centre)), p, n, triangle, 2.0 * l.texel, id, occluder);
    if (state == kLit || state == kBeside) sum += unshadowed;
  }
  return sum;
}
#include "clustered_voxel/visibility/visibility.h"

// Tangents of n that turn smoothly with it (but at −z).
void frameOf(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float c = n.x * n.y * a;
  t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
  b = vec3(c, s + n.y * n.y * a, -n.y);
}

const float kNearLift = 1e-3;  // voxels

// The entries of a list, from the first to the last, that a ray from `origin` into the half space of n may meet: all that is not wholly below. nearestTriangle()
// takes hits from −0.5 lifts on, and meetsTriangle() triangles that are wider by kEdgeSlack.
uvec2 listAbove(uvec2 list, vec3 origin, vec3 n, uint own) {
  uvec2 above = uvec2(list.y, list.x);
  for (uint e = list.x; e < list.y; ++e) {
    uint id = listedTriangle(triangleIds(e));
    vec3 a, b, c;
    loadCorners(id, a, b, c);
    vec3 heights = vec3(dot(a - origin, n), dot(b - origin, n), dot(c - origin, n));
    float highest = max(heights.x, max(heights.y, heights.z)), lowest = min(heights.x, min(heights.y, heights.z));
    if (id != own && highest + 4.0 * kEdgeSlack * (highest - lowest) > -0.75 * kNearLift) above = uvec2(min(above.x, e), e + 1u);
  }
  return above;
}

// Blocks side by side with nearly one shift: as many as lanes walk together, so that they walk the same way.
const uint kShiftRun = 8u;

void main() {
  castBegin();
  uint i = radivoxItemIndex();
  uvec2 blocks = (uvec2(width, height) + 3u) / 4u;
  uint blockCount = blocks.x * blocks.y;
  uint place = min(i / blockCount, 15u);
  uint block = i % blockCount;
  uvec2 pixel = uvec2(block % blocks.x, block / blocks.x) * 4u + uvec2(place & 3u, place >> 2);
  // Lanes without a pixel, or with the sky in it, have no rays.
  bool isPixel = i / blockCount < 16u && pixel.x < width && pixel.y < height;
  vec4 position = isPixel ? imageLoad(positionImage, ivec2(pixel)) : vec4(0.0);
  uint end = position.w != 0.0 ? endRay : 0u;
  vec3 p = toGridSpace(grid, position.xyz);
  vec3 n = end > 0u ? imageLoad(normalImage, ivec2(pixel)).xyz : vec3(0.0, 0.0, 1.0);
  // Triangles need no lift but against rounding; mean planes do.
  vec3 origin = kNear ? p + kNearLift * n : liftedOrigin(p, n);
  ivec3 start = clamp(ivec3(floor(origin)), ivec3(0), ivec3(castSize) - 1);
  bool crowded = false;
  uint excluded = 0x3fu;
  uint startVoxel = voxelIndex(start);
  bool walks = kWork != kLightOnly && startVoxel != kNone;
  if (walks) excluded = ownPlanes(startVoxel, uvec3(start), p, n, crowded);
  uint own = end > 0u ? imageLoad(triangleImage, ivec2(pixel)).x - 1u : 0u;
  uvec2 startList = kWholeList;
  if (kNear && end > 0u && walks) startList = listAbove(uvec2(triangleFirst(startVoxel), triangleFirst(startVoxel + 1u)), origin, n, own);
  vec3 t, b;
  frameOf(n, t, b);

  // Every block has a shift of its own: the same directions everywhere would miss the same things everywhere.
  uint hashed = hashBits(block / kShiftRun + 0x68bc21ebu);
  vec2 shift = vec2(uvec2(hashed, hashBits(hashed)) >> 8) * (1.0 / 16777216.0);
  // Within a run as far as directions are from one another: what one block misses the next meets, and lanes hardly part.
  uint inRun = block % kShiftRun;
  shift += (vec2(float(inRun), float(bitfieldReverse(inRun) >> 29)) + 0.5) * (inversesqrt(16.0 * float(rays)) / float(kShiftRun));

  bool goesOn = kWork != kTraceOnly && firstRay > 0u && end > 0u;
  vec4 sum = goesOn ? imageLoad(rawImage, ivec2(pixel)) : vec4(0.0);
  vec3 skySum = kSkyImage && goesOn ? imageLoad(rawSkyImage, ivec2(pixel)).xyz : vec3(0.0);
  vec3 emittedSum = kEmitted && goesOn ? imageLoad(rawEmittedImage, ivec2(pixel)).xyz : vec3(0.0);
  uint cell = pixel.y * width + pixel.x;
  bool addsSquares = kSpread && goesOn;
  float squareSum = addsSquares ? Squares(squares).of[cell] : 0.0;
  float skySquareSum = addsSquares && kSkyImage ? Squares(skySquares).of[cell] : 0.0;
  float emittedSquareSum = addsSquares && kEmitted ? Squares(emittedSquares).of[cell] : 0.0;
  for (uint ray = firstRay; ray < end; ++ray) {
    vec2 square = fract(directions[place * rays + ray] + shift);
    float radius = sqrt(square.x), turn = 6.283185307179586 * square.y;
    TraversalRay way = makeTraversalRay(origin, (t * cos(turn) + b * sin(turn)) * radius + n * sqrt(1.0 - square.x));
    WalkHit hit;
    uint kept = ray * width * height + cell;
    if (kWork == kLightOnly) hit = keptHit(way, Hits(hits).of[kept]);
    else hit = walkRay(way, start, excluded, startList, own, kNearLift, kNear ? nearDistance : 0.0, rayRandom(i, ray));
    if (kWork == kTraceOnly) {
      Hits(hits).of[kept] = uvec2(hit.face, hit.triangle);
      continue;
    }
    bool isFace = hit.face < kHitBack;
    uint face = isFace ? hit.face : 0u;
    vec3 radiosity = faceRadiosity[face];
    // Close by, a voxel is a coarse patch of light and shadow: what is sunlit at the hit itself counts.
    bool exact = isFace && hit.triangle != kNone;
    if (kShadow && exact) {
      vec3 at = position.xyz + (kNearLift * n + hit.time * way.direction) * grid.h;
      vec3 change = directIrradiance(at, hit.normal, hit.triangle) - faceIrradiance[face];
      if (kSky) change += skyIrradiance[face];
      radiosity = max(radiosity + decodeAlbedo(faceAt(face).albedo) * change, vec3(0.0));
    }
    vec3 emitted = kEmitted && isFace ? Emission(emission).of[face] : vec3(0.0);
    bool missed = hit.face == kHitNothing;
    vec3 skyLight = vec3(0.0);
    if (kSkyImage && missed) {
      SceneInfo info = InfoAt(skyInfo).info;
      skyLight = info.skyRadiance + SkyValues(sky).values[skyCell(way.direction, info.skyTurn)];
    }
    sum += vec4(isFace ? radiosity : vec3(0.0), missed ? 1.0 : 0.0);
    skySum += skyLight;
    emittedSum += emitted;
    if (kSpread) {
      float arriving = isFace ? luminanceOf(radiosity) : 0.0;
      squareSum += arriving * arriving;
      float arrivingSky = 3.14159265358979 * luminanceOf(skyLight), arrivingEmitted = luminanceOf(emitted);
      skySquareSum += arrivingSky * arrivingSky;
      emittedSquareSum += arrivingEmitted * arrivingEmitted;
    }
  }
  if (!isPixel || kWork == kTraceOnly) return;
  bool done = endRay == rays;
  if (kSkyImage) imageStore(rawSkyImage, ivec2(pixel), vec4(done ? 3.14159265358979 / float(rays) * skySum : skySum, 0.0));
  if (kEmitted) imageStore(rawEmittedImage, ivec2(pixel), vec4(done ? emittedSum / float(rays) : emittedSum, 0.0));
  if (kSpread) {
    float share = done ? 1.0 / float(rays) : 1.0;
    Squares(squares).of[cell] = share * squareSum;
    if (kSkyImage) Squares(skySquares).of[cell] = share * skySquareSum;
    if (kEmitted) Squares(emittedSquares).of[cell] = share * emittedSquareSum;
  }
  imageStore(rawImage, ivec2(pixel), done ? sum / float(rays) : sum);
}
