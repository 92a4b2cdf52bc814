#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The voxels themselves, as cubes: the first occupied one on each pixel's ray, and its face on the side where the ray comes in (or, where
// that side has none, the face that looks at the viewer most).
#include "shared/dispatch.glsl"
#include "clustered_voxel/structure.glsl"
#include "shared/scene.h"
#include "shared/traversal.glsl"
#include "viewer/faces.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 6, scalar) readonly buffer CameraBuffer { Camera camera; };
layout(set = 0, binding = 7, scalar) writeonly buffer Pixels { uvec2 pixels[]; };

vec3 unproject(vec2 ndc, float depth) {
  vec4 p = camera.inverseViewProjection * vec4(ndc, depth, 1.0);
  return p.xyz / p.w;
}

void main() {
  uint i = radivoxItemIndex();
  if (i >= camera.width * camera.height) return;
  vec2 ndc = (vec2(i % camera.width, i / camera.width) + 0.5) / vec2(camera.width, camera.height) * 2.0 - 1.0;
  vec3 from = unproject(ndc, 1.0);  // on the near plane
  vec3 direction = camera.forward;
  if (camera.orthographic == 0u) direction = normalize(from - camera.position);
  TraversalRay ray = makeTraversalRay(toGridSpace(grid, from), direction);
  TraversalCursor cursor;
  uint result = 0u;
  float shade = 1.0;
  bool inside = traversalBegin(ray, vec3(grid.size), cursor);
  vec3 entered = traversalFirst(traversalExits(ray, cursor.voxel));
  for (uint steps = grid.size.x + grid.size.y + grid.size.z + 4u; inside && steps > 0u; --steps) {
    ivec3 coordinate = ivec3(cursor.voxel);
    uint brick = brickOf(uvec3(coordinate), grid.bricks);
    if (any(notEqual(brickBits(brick), uvec2(0u))) && isOccupied(coordinate)) {
      uint axis = entered.x > 0.5 ? 0u : (entered.y > 0.5 ? 1u : 2u);
      uint voxel = voxelIndex(coordinate);
      uint best = faceIndex(voxel, 2u * axis + (ray.direction[axis] > 0.0 ? 1u : 0u));
      float most = 0.0;
      for (uint f = 0; best == kNone && f < kFaceCount; ++f) {
        if (!hasFace(voxel, f) || -dot(faceVector(f), ray.direction) <= most) continue;
        most = -dot(faceVector(f), ray.direction);
        best = faceIndex(voxel, f);
        f = kFaceCount - 1u;
      }
      result = best != kNone ? best + 1u : kSolid;
      vec3 point = clamp(ray.origin + cursor.time * ray.direction - cursor.voxel, 0.0, 1.0);
      float along = camera.orthographic != 0u ? 1.0 : cursor.time / grid.inverseH;
      shade = edgeShade(point, axis, along * camera.pixelAngle * grid.inverseH) * (axis == 1u ? 1.0 : (axis == 0u ? 0.9 : 0.8));
      break;
    }
    entered = traversalFirst(traversalExits(ray, cursor.voxel));
    traversalStep(ray, cursor);
    inside = all(greaterThanEqual(cursor.voxel, vec3(0.0))) && all(lessThan(cursor.voxel, vec3(grid.size)));
  }
  pixels[i] = uvec2(result, floatBitsToUint(shade));
}
