#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a pixel: the mean radiosity along its share of the block's directions. See modules/clustered_voxel/gather_pixels/gather_pixels.h.
#include "shared/dispatch.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSkip = 2;

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
layout(set = 0, binding = 10, scalar) readonly buffer DirectionBuffer { vec4 directions[]; };
layout(set = 0, binding = 11, rgba32f) writeonly uniform image2D rawImage;
layout(push_constant, scalar) uniform Push {
  uint width;
  uint height;
  uint rays;
  uint voxelCount;
};
#include "clustered_voxel/structure.glsl"
#include "shared/voxel_cast.glsl"
#include "clustered_voxel/visibility/visibility.h"

// Tangents of n that turn smoothly with it (but at −z).
void frameOf(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float c = n.x * n.y * a;
  t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
  b = vec3(c, s + n.y * n.y * a, -n.y);
}

void main() {
  castBegin();
  uint i = radivoxItemIndex();
  uvec2 blocks = (uvec2(width, height) + 3u) / 4u;
  uint blockCount = blocks.x * blocks.y;
  uint place = min(i / blockCount, 15u);
  uint block = i % blockCount;
  uvec2 pixel = uvec2(block % blocks.x, block / blocks.x) * 4u + uvec2(place & 3u, place >> 2);
  // No lane leaves early (castMarch): those without a pixel, or with the sky in it, have no rays.
  bool isPixel = i / blockCount < 16u && pixel.x < width && pixel.y < height;
  vec4 position = isPixel ? imageLoad(positionImage, ivec2(pixel)) : vec4(0.0);
  uint end = position.w != 0.0 ? rays : 0u;
  vec3 p = toGridSpace(grid, position.xyz);
  vec3 n = end > 0u ? imageLoad(normalImage, ivec2(pixel)).xyz : vec3(0.0, 0.0, 1.0);
  vec3 origin = liftedOrigin(p, n);
  ivec3 start = clamp(ivec3(floor(origin)), ivec3(0), ivec3(castSize) - 1);
  bool crowded = false;
  uint excluded = 0x3fu;
  uint voxel = voxelIndex(start);
  if (voxel != kNone) excluded = ownPlanes(voxel, uvec3(start), p, n, crowded);
  vec3 t, b;
  frameOf(n, t, b);

  // As in visibility/trace.comp: lanes go on to their next ray each on its own.
  vec4 sum = vec4(0.0);
  TraversalRay way = makeTraversalRay(origin, n);
  TraversalCursor cursor = TraversalCursor(vec3(start), 0.0);
  uint inFront = 0u;
  bool fresh = true;
  uint ray = 0u;
  while (subgroupAny(ray < end)) {
    bool busy = ray < end;
    uint at = min(ray, rays - 1u);
    vec3 local = directions[place * rays + at].xyz;
    TraversalRay next = makeTraversalRay(origin, t * local.x + b * local.y + n * local.z);
    way.direction = mix(way.direction, next.direction, bvec3(fresh));
    way.inverse = mix(way.inverse, next.inverse, bvec3(fresh));
    way.forward = mix(way.forward, next.forward, bvec3(fresh));
    cursor.voxel = mix(cursor.voxel, vec3(start), bvec3(fresh));
    cursor.time = fresh ? 0.0 : cursor.time;
    inFront = fresh ? 0u : inFront;
    bool stay = fresh && crowded;
    TraversalCursor stepped = cursor;
    traversalStep(way, stepped);
    cursor.voxel = mix(stepped.voxel, cursor.voxel, bvec3(stay));
    cursor.time = stay ? cursor.time : stepped.time;
    if (castMarch(way, cursor, busy && !stay)) inFront = 0u;
    bool outside = isOutside(cursor.voxel);
    uint hit = castFace(way, cursor, busy, stay ? excluded : 0u, inFront, rayRandom(i, at));
    fresh = !busy || outside || hit != kHitNothing;
    bool isFace = busy && !outside && hit < kHitBack;
    vec3 radiosity = faceRadiosity[isFace ? hit : 0u];
    sum.xyz += isFace ? radiosity : vec3(0.0);
    sum.w += busy && outside ? 1.0 : 0.0;
    ray += fresh && busy ? 1u : 0u;
  }
  if (isPixel) imageStore(rawImage, ivec2(pixel), end > 0u ? sum / float(rays) : vec4(0.0));
}
